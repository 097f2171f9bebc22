//! The reference of summaries in docs/json.md follows from the types that are written as JSON, and from their doc comments.
//!
//! The summary of every study has a table there, and so have events, which Python gives. `ARCHROCK_GOLDEN=write cargo test summaries` writes them anew.

use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};

use crate::common::documents::{assert_generated, assert_generated_file};
use syn::{Attribute, Expr, Field, Fields, GenericArgument, Item, Lit, Meta, PathArguments, Type};

/// A type that is written as JSON, and its file.
struct Written {
    file: PathBuf,
    name: String,
    doc: String,
    /// Doc comment and fields: of the one variant of a struct, or of all of an enum.
    variants: Vec<(String, Fields)>,
    /// True if its JSON is the JSON of its only field.
    is_transparent: bool,
}

fn source() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("src")
}

/// All types with `derive(Serialize)` in a folder.
fn written(folder: &Path, found: &mut Vec<Written>) {
    let mut paths: Vec<_> = fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .collect();
    paths.sort();
    for file in paths {
        if file.is_dir() {
            written(&file, found);
        } else if file.extension().is_some_and(|ending| ending == "rs") {
            let items = syn::parse_file(&fs::read_to_string(&file).unwrap());
            for item in items.unwrap().items {
                let (attributes, name, variants) = match item {
                    Item::Struct(one) => (one.attrs, one.ident, vec![(String::new(), one.fields)]),
                    Item::Enum(one) => {
                        let variants = one.variants.into_iter();
                        let variants = variants.map(|one| (doc(&one.attrs), one.fields));
                        (one.attrs, one.ident, variants.collect())
                    }
                    _ => continue,
                };
                if list(&attributes, "derive").contains("Serialize") {
                    found.push(Written {
                        file: file.clone(),
                        name: name.to_string(),
                        doc: doc(&attributes),
                        variants,
                        is_transparent: list(&attributes, "serde").contains("transparent"),
                    });
                }
            }
        }
    }
}

/// The doc comment, as one line.
fn doc(attributes: &[Attribute]) -> String {
    let lines = attributes
        .iter()
        .filter_map(|attribute| match &attribute.meta {
            Meta::NameValue(pair) if pair.path.is_ident("doc") => match &pair.value {
                Expr::Lit(text) => match &text.lit {
                    Lit::Str(text) => Some(text.value().trim().to_owned()),
                    _ => None,
                },
                _ => None,
            },
            _ => None,
        });
    lines
        .collect::<Vec<_>>()
        .join(" ")
        .replace('|', "\\|")
        .replace("`None`", "null")
}

/// The words in the brackets of an attribute.
fn list(attributes: &[Attribute], name: &str) -> String {
    let lists = attributes
        .iter()
        .filter_map(|attribute| match &attribute.meta {
            Meta::List(list) if list.path.is_ident(name) => Some(list.tokens.to_string()),
            _ => None,
        });
    lists.collect::<Vec<_>>().join(", ")
}

/// The name of a type, and the first type in its brackets.
fn parts(kind: &Type) -> (String, Option<&Type>) {
    match kind {
        Type::Path(path) => {
            let last = path.path.segments.last().unwrap();
            let inner = match &last.arguments {
                // For a map, the name of the type of its values.
                PathArguments::AngleBracketed(inner) => inner.args.last(),
                _ => None,
            };
            let inner = inner.and_then(|inner| match inner {
                GenericArgument::Type(inner) => Some(inner),
                _ => None,
            });
            (last.ident.to_string(), inner)
        }
        Type::Array(array) => ("Vec".to_owned(), Some(&array.elem)),
        Type::Tuple(tuple) => ("Vec".to_owned(), tuple.elems.first()),
        Type::Reference(reference) => parts(&reference.elem),
        _ => (String::new(), None),
    }
}

/// The keys of a map, in words.
fn keys_of(map: &Type) -> &'static str {
    let Type::Path(path) = map else { return "" };
    let PathArguments::AngleBracketed(inner) = &path.path.segments.last().unwrap().arguments else {
        return "";
    };
    let Some(GenericArgument::Type(key)) = inner.args.first() else {
        return "";
    };
    match &*parts(key).0 {
        "Sway" => "`right`, `left`: ",
        "LimitState" => "`sld`, `slv`, `slc`: ",
        _ => "by name: ",
    }
}

/// The JSON that a function of a file for `serialize_with` writes, in words.
fn written_by(function: &str, file: &Path) -> &'static str {
    let text = fs::read_to_string(file).unwrap();
    let (_, body) = text.split_once(&format!("\nfn {function}<")).unwrap();
    let (body, _) = body.split_once("\n}\n").unwrap();
    let words = [
        ("f64", "number"),
        ("to_degrees", "number"),
        ("serialize_str", "text"),
    ];
    let known = words.iter().find(|(code, _)| body.contains(code));
    known.unwrap_or_else(|| panic!("{function} is not known")).1
}

/// The type of a value in words, and the name of the type inside.
fn words(kind: &Type) -> (String, String) {
    let (name, inner) = parts(kind);
    match (&*name, inner) {
        ("Option", Some(inner)) => wrapped(inner, "", " or null"),
        ("Vec", Some(inner)) => wrapped(inner, "list: ", ""),
        ("BTreeMap", Some(inner)) => wrapped(inner, keys_of(kind), ""),
        ("Sides", Some(inner)) => wrapped(inner, "`right`, `left`: ", ""),
        ("Vector2", _) => ("list: x, y".to_owned(), String::new()),
        ("f64", _) => ("number".to_owned(), name),
        ("usize" | "u64" | "u32" | "u8", _) => ("whole number".to_owned(), name),
        ("bool", _) => ("true or false".to_owned(), name),
        ("Named", Some(inner)) => wrapped(inner, "by name: ", ""),
        ("Value" | "Map", _) => ("object".to_owned(), name),
        _ => ("text".to_owned(), name),
    }
}

/// The type of a value in Python, with `str` for texts and objects.
fn annotation(kind: &Type) -> String {
    let (name, inner) = parts(kind);
    match (&*name, inner) {
        ("Option", Some(inner)) => format!("{} | None", annotation(inner)),
        ("Vec", Some(inner)) => format!("list[{}]", annotation(inner)),
        ("Sides", Some(inner)) => format!("BySide[{}]", annotation(inner)),
        ("BTreeMap" | "Named", Some(inner)) => format!("dict[Any, {}]", annotation(inner)),
        ("Vector2", _) => "list[float]".to_owned(),
        ("Value" | "Map", _) => "dict[str, Any]".to_owned(),
        _ => in_python(&words(kind).0).to_owned(),
    }
}

/// The type in Python of a value with this type in words.
fn in_python(words: &str) -> &'static str {
    match words {
        "number" => "float",
        "whole number" => "int",
        "true or false" => "bool",
        _ => "str",
    }
}

fn wrapped(inner: &Type, before: &str, after: &str) -> (String, String) {
    let (words, name) = words(inner);
    (format!("{before}{words}{after}"), name)
}

/// A key with its type, and its meanings, each after the variant of an enum that has it.
struct Row {
    key: String,
    kind: String,
    /// Its type in Python.
    annotation: String,
    meanings: Vec<[String; 2]>,
}

/// The table of a summary.
struct Reference<'a> {
    written: &'a [Written],
    rows: Vec<Row>,
    /// Name of its class in Python.
    class: String,
    /// Types that have their rows already, with the key of the first value.
    known: Vec<(&'a Written, String)>,
}

impl<'a> Reference<'a> {
    /// Adds rows of the fields of a type, and of those inside them.
    fn add(&mut self, one: &'a Written, before: &str) {
        for (variant, fields) in &one.variants {
            for field in fields {
                self.add_field(one, before, variant, field);
            }
        }
    }

    fn add_field(&mut self, one: &Written, before: &str, variant: &str, field: &Field) {
        let serde = list(&field.attrs, "serde");
        if serde.split(", ").any(|word| word == "skip") {
            return;
        }
        let (mut kind, name) = words(&field.ty);
        let text_after = |word: &str| {
            let (_, text) = serde.split_once(&format!("{word} = \""))?;
            text.split('"').next()
        };
        let mut annotation = annotation(&field.ty);
        let mut inside = self.found(one, &name);
        if let Some(transparent) = inside.filter(|inside| inside.is_transparent) {
            let value = transparent.variants[0].1.iter().next().unwrap();
            let (value_in_words, name_in_value) = words(&value.ty);
            kind = kind.replace("text", &value_in_words);
            annotation = annotation.replace("str", in_python(&value_in_words));
            inside = self.found(transparent, &name_in_value);
        }
        let Some(ident) = field.ident.as_ref().filter(|_| !serde.contains("flatten")) else {
            // The fields of another type in place of this one.
            if let Some(inside) = inside {
                let side = if kind.starts_with("`right`") {
                    "right."
                } else {
                    ""
                };
                self.add(inside, &format!("{before}{side}"));
            }
            return;
        };
        let name = text_after("rename").map_or_else(|| ident.to_string(), str::to_owned);
        let key = format!("{before}{name}");
        if let Some(function) = text_after("serialize_with") {
            kind = written_by(function, &one.file).to_owned();
            in_python(&kind).clone_into(&mut annotation);
            inside = None;
        }
        let is_object = |one: &&Written| one.variants.iter().any(|(_, fields)| !fields.is_empty());
        let inside = inside.filter(is_object);
        let known = self
            .known
            .iter()
            .find(|(known, _)| inside.is_some_and(|inside| std::ptr::eq(*known, inside)));
        let known = known.map(|(_, key)| key.clone());
        if inside.is_some() {
            let as_before = known.as_ref().map(|key| format!(" as `{key}`"));
            kind = kind.replace("text", &format!("object{}", as_before.unwrap_or_default()));
            let class = class_of(&self.class, known.as_ref().unwrap_or(&key));
            annotation = annotation.replace("str", &class);
        }
        if serde.contains("skip_serializing_if") {
            kind = kind.strip_suffix(" or null").unwrap_or(&kind).to_owned() + ", or absent";
        }
        let meaning = [variant.to_owned(), doc(&field.attrs)];
        self.add_row(key.clone(), [kind, annotation], meaning);
        if let Some(inside) = inside.filter(|_| known.is_none()) {
            self.known.push((inside, key.clone()));
            self.add(inside, &format!("{key}."));
        }
    }

    /// Adds a row. Variants of an enum that have the same key share its row.
    fn add_row(&mut self, key: String, [kind, annotation]: [String; 2], meaning: [String; 2]) {
        let Some(row) = self.rows.iter_mut().find(|row| row.key == key) else {
            let meanings = vec![meaning];
            self.rows.push(Row {
                key,
                kind,
                annotation,
                meanings,
            });
            return;
        };
        if kind.len() > row.kind.len() {
            (row.kind, row.annotation) = (kind, annotation);
        }
        match &mut row.meanings[..] {
            [[variant, known]] if *known == meaning[1] => variant.clear(),
            known if known.iter().any(|[_, known]| *known == meaning[1]) => {}
            _ => row.meanings.push(meaning),
        }
    }

    /// The type of this name: if several modules have one, that of the same file, or else of the nearest folder.
    fn found(&self, from: &Written, name: &str) -> Option<&'a Written> {
        let shared = |other: &&Written| {
            let pairs = other.file.components().zip(from.file.components());
            pairs.take_while(|(a, b)| a == b).count()
        };
        let named = self.written.iter().filter(|other| other.name == name);
        named.max_by_key(shared)
    }
}

/// The name of a class of Python: that of a summary, with the key of an object in it.
fn class_of(summary: &str, key: &str) -> String {
    let words = key.split(['_', '.', '/']).filter(|word| !word.is_empty());
    let capital = |word: &str| word[..1].to_uppercase() + &word[1..];
    words.fold(summary.to_owned(), |name, word| name + &capital(word))
}

/// The names that classes of results define themselves in a file of the Python package.
fn defined_in_python(file: &str) -> Vec<String> {
    let package = Path::new(env!("CARGO_MANIFEST_DIR")).join("python/package/archrock");
    let text = fs::read_to_string(package.join(file)).unwrap();
    let names = text.split("    def ").skip(1);
    names
        .filter_map(|rest| Some(rest.split_once('(')?.0.to_owned()))
        .collect()
}

/// The classes of Python with the keys of a summary and of the objects in it, for type checkers. Those of a summary are also attributes of its result,
/// which has some names of its own.
fn python_classes(reference: &Reference<'_>) -> String {
    let parent_of = |key: &str| {
        key.rsplit_once('.')
            .map_or("", |(parent, _)| parent)
            .to_owned()
    };
    let mut parents = vec![String::new()];
    for row in &reference.rows {
        let parent = parent_of(&row.key);
        parents.extend((!parents.contains(&parent)).then_some(parent));
    }
    let defined = defined_in_python(match &*reference.class {
        "Run" => "_history.py",
        _ => "_studies.py",
    });
    let mut text = String::new();
    for parent in &parents {
        let class = class_of(&reference.class, parent);
        // Objects by side have no row of their own.
        let has_no_row = |key: &String| reference.rows.iter().all(|row| row.key != *key);
        let sides = parents
            .iter()
            .filter(|other| !other.is_empty() && parent_of(other) == *parent && has_no_row(other));
        let sides = sides.flat_map(|side| {
            let inside = class_of(&reference.class, side);
            ["right", "left"].map(|name| (name, inside.clone()))
        });
        let rows = reference.rows.iter();
        let rows = rows
            .filter(|row| parent_of(&row.key) == *parent)
            .map(|row| {
                let name = row.key.rsplit('.').next().unwrap();
                // Objects of variants without fields have no class.
                let class = class_of(&reference.class, &row.key);
                let has_class = parents.contains(&row.key) || !row.annotation.contains(&class);
                let annotation = row.annotation.clone();
                (
                    name,
                    if has_class {
                        annotation
                    } else {
                        annotation.replace(&class, "Any")
                    },
                )
            });
        // Words of Python, and methods of a dictionary.
        let is_attribute = |name: &str| {
            name.chars().all(|c| c.is_alphanumeric() || c == '_')
                && !["from", "with", "values", "keys", "items", "copy", "get"].contains(&name)
        };
        let attributes: Vec<_> = sides
            .chain(rows)
            .filter(|(name, _)| is_attribute(name))
            .collect();
        let lines = |text: &mut String, is_own: &dyn Fn(&str) -> bool| {
            for (name, annotation) in attributes.iter().filter(|(name, _)| is_own(name)) {
                let _ = writeln!(text, "    {name}: {annotation}");
            }
        };
        let _ = write!(text, "\nclass {class}Keys:\n");
        lines(&mut text, &|_| true);
        let _ = write!(text, "\nclass {class}(Summary, {class}Keys):\n    pass\n");
        if parent.is_empty() {
            let property = format!("    @property\n    def summary(self) -> {class}: ...\n");
            let _ = write!(text, "\nclass {class}Result:\n{property}");
            let is_defined = |name: &str| defined.iter().any(|own| own == name);
            lines(&mut text, &|name| !is_defined(name));
        }
    }
    text
}

/// The title of a study: its file, or its folder if several files share one.
fn title_of(file: &Path) -> String {
    let shared = ["mod", "report", "summary"].map(|name| file.with_file_name(format!("{name}.rs")));
    let study = match shared.contains(&file.to_owned()) {
        true => file.parent().unwrap(),
        false => &file.with_extension(""),
    };
    study.display().to_string()
}

#[test]
fn summaries_are_described_by_their_types() {
    let mut found = Vec::new();
    written(&source(), &mut found);
    let (mut text, mut classes) = (String::new(), String::new());
    let studies = source().join("studies");
    // `MapSummary` of the study `map`, `UncertainRunSummary` of `ensemble/uncertain_run`.
    let is_of_study = |one: &&Written| {
        let file = one.file.strip_prefix(&studies);
        let name = file.map(|file| title_of(file).rsplit('/').next().unwrap().replace('_', ""));
        name.is_ok_and(|study| one.name.to_lowercase() == study + "summary")
    };
    let summaries = found.iter().filter(is_of_study);
    // Python has the events of a history too.
    let events = found.iter().filter(|one| one.name == "Event");
    for one in summaries.chain(events) {
        let study = one.file.strip_prefix(&studies).ok();
        let title = study.map_or("event".to_owned(), title_of);
        let _ = write!(
            text,
            "\n### `{title}`\n\n{}\n\n| key | type | what it is |\n|---|---|---|\n",
            one.doc
        );
        let mut reference = Reference {
            written: &found,
            rows: Vec::new(),
            class: class_of("", &title),
            known: Vec::new(),
        };
        reference.add(one, "");
        classes += &python_classes(&reference);
        for row in &reference.rows {
            let meanings = row.meanings.iter().flatten();
            let meanings: Vec<&str> = meanings.map(String::as_str).collect();
            let meaning = meanings.join(" ");
            let _ = writeln!(
                text,
                "| `{}` | {} | {} |",
                row.key,
                row.kind,
                meaning.trim()
            );
        }
    }
    assert!(text.matches("###").count() >= 2, "{text}");
    assert_generated(
        "docs/json.md",
        "tests/program/summaries.rs from the types of src",
        &text,
    );
    assert_generated_file(
        "python/package/archrock/_keys.pyi",
        &format!(
            "# Written by tests/program/summaries.rs from the types of src: the keys of results, for type checkers.\n\n\
             from typing import Any, Generic, TypeVar\n\nfrom ._summary import Summary\n\n_T = TypeVar(\"_T\")\n\n\
             class BySide(Summary, Generic[_T]):\n    right: _T\n    left: _T\n{classes}"
        ),
    );
}
