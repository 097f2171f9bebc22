//! The public items of all packages, as listed in tests/golden/public-api.txt: a change of them is a decision, and belongs in CHANGELOG.md.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

use crate::common::prose::golden;
use syn::{Attribute, Fields, ImplItem, Item, Meta, TraitItem, Type, UseTree, Visibility};

/// Names from the package down to a module or an item.
type Names = Vec<String>;

/// A name in a module: an item with its listed parts, or the import of another.
enum Entry {
    Module,
    Item(String),
    Import(Names),
}

/// The modules of all packages.
#[derive(Default)]
struct Packages {
    /// All names of a module; true if they are public.
    entries: BTreeMap<Names, Vec<(String, bool, Entry)>>,
    /// Public functions and constants of types: the module of their `impl`, the name of the type there, and their own names.
    members: Vec<(Names, Names, Vec<String>)>,
}

fn joined(path: &[String], name: &str) -> Names {
    path.iter().cloned().chain([name.to_owned()]).collect()
}

fn is_public(visibility: &Visibility) -> bool {
    matches!(visibility, Visibility::Public(_))
}

/// True for tests, and for parts that are behind a feature for tests.
fn is_internal(attributes: &[Attribute]) -> bool {
    attributes.iter().any(|attribute| match &attribute.meta {
        Meta::List(list) if list.path.is_ident("cfg") => {
            let words = list.tokens.to_string();
            words.contains("test") || words.contains("internals")
        }
        _ => false,
    })
}

fn fields(fields: &Fields) -> String {
    let public = fields.iter().filter(|field| is_public(&field.vis));
    let names = public.map(|field| match &field.ident {
        Some(name) => name.to_string(),
        None => "_".to_owned(),
    });
    names.collect::<Vec<_>>().join(", ")
}

/// The imports of a tree: the name in the module, and the path.
fn imports(tree: &UseTree, before: &[String], found: &mut Vec<(String, Names)>) {
    match tree {
        UseTree::Path(path) => {
            imports(&path.tree, &joined(before, &path.ident.to_string()), found);
        }
        UseTree::Name(name) if name.ident == "self" => {
            found.push((before.last().unwrap().clone(), before.to_vec()));
        }
        UseTree::Name(name) => {
            let name = name.ident.to_string();
            found.push((name.clone(), joined(before, &name)));
        }
        UseTree::Rename(rename) => {
            let path = joined(before, &rename.ident.to_string());
            found.push((rename.rename.to_string(), path));
        }
        UseTree::Group(group) => {
            for tree in &group.items {
                imports(tree, before, found);
            }
        }
        UseTree::Glob(_) => found.push(("*".to_owned(), before.to_vec())),
    }
}

impl Packages {
    /// Reads a module and all below it; `folder` has the files of its modules.
    fn read(&mut self, module: &[String], file: &Path, folder: &Path) {
        let items = syn::parse_file(&fs::read_to_string(file).unwrap())
            .unwrap()
            .items;
        for item in items {
            self.add(module, item, folder);
        }
    }

    fn add(&mut self, module: &[String], item: Item, folder: &Path) {
        let mut entries = Vec::new();
        let mut list = |name: &syn::Ident, visibility: &Visibility, entry: Entry| {
            entries.push((name.to_string(), is_public(visibility), entry));
        };
        match item {
            Item::Mod(one) if !is_internal(&one.attrs) => {
                list(&one.ident, &one.vis, Entry::Module);
                let (name, below) = (
                    one.ident.to_string(),
                    joined(module, &one.ident.to_string()),
                );
                self.entries.entry(below.clone()).or_default();
                if let Some((_, items)) = one.content {
                    for item in items {
                        self.add(&below, item, &folder.join(&name));
                    }
                } else {
                    let files: [PathBuf; 2] = [
                        folder.join(&name).with_extension("rs"),
                        folder.join(&name).join("mod.rs"),
                    ];
                    let file = files.iter().find(|file| file.exists()).unwrap();
                    self.read(&below, file, &folder.join(&name));
                }
            }
            Item::Struct(one) => {
                let parts = format!("struct {{ {} }}", fields(&one.fields));
                list(&one.ident, &one.vis, Entry::Item(parts));
            }
            Item::Enum(one) => list(&one.ident, &one.vis, Entry::Item(variants(&one))),
            Item::Trait(one) => {
                let names = one.items.iter().filter_map(|item| match item {
                    TraitItem::Fn(function) => Some(function.sig.ident.to_string()),
                    TraitItem::Const(constant) => Some(constant.ident.to_string()),
                    TraitItem::Type(one) => Some(one.ident.to_string()),
                    _ => None,
                });
                let parts = format!("trait {{ {} }}", names.collect::<Vec<_>>().join(", "));
                list(&one.ident, &one.vis, Entry::Item(parts));
            }
            Item::Fn(one) => list(&one.sig.ident, &one.vis, Entry::Item("fn".to_owned())),
            Item::Const(one) => list(&one.ident, &one.vis, Entry::Item("const".to_owned())),
            Item::Static(one) => list(&one.ident, &one.vis, Entry::Item("static".to_owned())),
            Item::Type(one) => list(&one.ident, &one.vis, Entry::Item("type".to_owned())),
            // `named!` has an enum whose variants have names.
            Item::Macro(one) => {
                if let Ok(named) = one.mac.parse_body::<syn::ItemEnum>() {
                    list(&named.ident, &named.vis, Entry::Item(variants(&named)));
                }
            }
            Item::Use(one) => {
                let mut found = Vec::new();
                imports(&one.tree, &[], &mut found);
                for (name, path) in found {
                    entries.push((name, is_public(&one.vis), Entry::Import(path)));
                }
            }
            Item::Impl(one) if one.trait_.is_none() && !is_internal(&one.attrs) => {
                if let Type::Path(of) = &*one.self_ty {
                    let names = one.items.iter().filter_map(|item| match item {
                        ImplItem::Fn(own) if is_public(&own.vis) => Some(own.sig.ident.to_string()),
                        ImplItem::Const(own) if is_public(&own.vis) => Some(own.ident.to_string()),
                        _ => None,
                    });
                    let names = names.collect();
                    let of = of.path.segments.iter().map(|part| part.ident.to_string());
                    self.members.push((module.to_vec(), of.collect(), names));
                }
            }
            _ => {}
        }
        self.entries
            .entry(module.to_vec())
            .or_default()
            .extend(entries);
    }

    /// The item or module that a path means in a module; `None` if it is in another package.
    fn resolved(&self, module: &[String], path: &[String]) -> Option<Names> {
        let mut at = module.to_vec();
        let mut rest = path;
        match path[0].as_str() {
            "crate" => at.truncate(1),
            "self" => {}
            "super" => drop(at.pop()),
            package if self.entries.contains_key(&vec![package.to_owned()]) => {
                at = vec![package.to_owned()];
            }
            _ => {
                at = self.found(&at, &path[0])?;
            }
        }
        rest = &rest[1..];
        while let Some((name, after)) = rest.split_first() {
            if name == "super" {
                at.pop();
            } else {
                at = self.found(&at, name)?;
            }
            rest = after;
        }
        Some(at)
    }

    /// The item or module of this name in a module.
    fn found(&self, module: &[String], name: &str) -> Option<Names> {
        let (_, _, entry) = self.entries.get(module)?.iter().find(|one| one.0 == name)?;
        match entry {
            Entry::Module | Entry::Item(_) => Some(joined(module, name)),
            Entry::Import(path) => self.resolved(module, path),
        }
    }

    /// Adds the public paths of all items below a public module.
    fn list(
        &self,
        public: &[String],
        module: &[String],
        paths: &mut BTreeMap<Names, BTreeSet<Names>>,
    ) {
        for (name, is_public, entry) in &self.entries[module] {
            let target = match entry {
                _ if !is_public => None,
                Entry::Import(path) => self.resolved(module, path),
                _ => Some(joined(module, name)),
            };
            let Some(target) = target else { continue };
            let path = joined(public, name);
            if self.entries.contains_key(&target) {
                // A module that is public twice is listed once.
                if paths.entry(target.clone()).or_default().is_empty() {
                    paths.get_mut(&target).unwrap().insert(path.clone());
                    self.list(&path, &target, paths);
                }
            } else {
                paths.entry(target).or_default().insert(path);
            }
        }
    }
}

fn variants(one: &syn::ItemEnum) -> String {
    let names = one.variants.iter().map(|variant| variant.ident.to_string());
    format!("enum {{ {} }}", names.collect::<Vec<_>>().join(", "))
}

#[test]
fn the_public_items_are_those_of_the_list() {
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut packages = Packages::default();
    let sources = [
        ("archrock_text", source.join("text")),
        ("archrock_draw", source.join("draw")),
        ("archrock_motion", source.join("motion")),
        ("archrock_records", source.join("records")),
        ("archrock", source),
    ];
    for (package, folder) in &sources {
        packages.read(&[(*package).to_owned()], &folder.join("lib.rs"), folder);
    }
    let mut paths = BTreeMap::new();
    for (package, _) in sources {
        let root = vec![package.to_owned()];
        packages.list(&root, &root, &mut paths);
    }
    let mut lines = Vec::new();
    for (target, all) in &paths {
        let first = all.iter().min_by_key(|path| path.len()).unwrap();
        let others = all.iter().filter(|path| *path != first);
        lines.extend(others.map(|path| format!("{}: {}", path.join("::"), first.join("::"))));
        let (name, module) = target.split_last().unwrap();
        let entry = packages.entries[module].iter().find(|one| one.0 == *name);
        if let Some((_, _, Entry::Item(parts))) = entry {
            lines.push(format!("{}: {parts}", first.join("::")));
        }
    }
    for (module, of, names) in &packages.members {
        let target = packages.resolved(module, of);
        if let Some(all) = target.and_then(|target| paths.get(&target)) {
            let first = all.iter().min_by_key(|path| path.len()).unwrap();
            lines.extend(
                names
                    .iter()
                    .map(|name| format!("{}::{name}", first.join("::"))),
            );
        }
    }
    lines.sort();
    assert!(lines.len() > 500, "{}", lines.len());
    golden("public-api", &(lines.join("\n") + "\n"));
}

/// Items that only tests need are in one hidden module, which no example and no page shows.
#[test]
fn one_module_is_hidden_from_users() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut folders = ["src", "examples", "docs"]
        .map(|folder| root.join(folder))
        .to_vec();
    let (mut hidden, mut read) = (Vec::new(), 0);
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
                continue;
            }
            let Ok(text) = fs::read_to_string(&path) else {
                continue;
            };
            read += 1;
            let path = path.strip_prefix(root).unwrap().to_path_buf();
            hidden.extend(text.matches("doc(hidden)").map(|_| path.clone()));
            // Examples need only names that the root of the crate exports.
            let deeper = ["studies", "dynamics", "mechanics", "scenario", "output"];
            let deeper = deeper.map(|module| format!("archrock::{module}"));
            let example = path.starts_with("examples");
            assert!(
                !example || deeper.iter().all(|name| !text.contains(name)),
                "{}",
                path.display()
            );
            let own = path == Path::new("docs/architecture.md");
            assert!(own || !text.contains("internals::"), "{}", path.display());
        }
    }
    assert!(read > 100, "{read} files");
    hidden.sort();
    assert_eq!(hidden, [Path::new("src/motion/lib.rs")]);
}
