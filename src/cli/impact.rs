//! The command `impact`.

use std::fmt::Write as _;
use std::io;
use std::path::{Path, PathBuf};

use archrock::dynamics::model::MechanismModel;
use archrock::mechanics::chain::Hinge;
use archrock::mechanics::four_link::arch::FourLinkArch;
use archrock::mechanics::four_link::certificate::{
    DEFAULT_JOINTS, Projection, joints_rad, project,
};
use archrock::mechanics::four_link::chain::ArchLink;
use archrock::mechanics::four_link::impact::{
    Impact, ImpactModel, closing_field, impact as impact_by,
};
use archrock::mechanics::four_link::mechanism::{FourLink, HingeSites};
use archrock::mechanics::four_link::resultant::{Extremes, Extremum};
use archrock::mechanics::geometry::ring::Edge;
use archrock::mechanics::sway::Sway;
use archrock::output::{Folder, impact as output, pictures};
use archrock::scenario::{Scenario, Structure};
use serde_json::json;

use super::commands::{self, degrees, pretty};
use super::figure::FigureOption;
use super::scenario_file::ScenarioFile;
use super::{Failure, Format, print};

#[derive(clap::Args)]
pub struct Arguments {
    #[command(flatten)]
    scenario: ScenarioFile,
    /// Number of impacts to print.
    #[arg(long, value_name = "N", default_value_t = 5, value_parser = clap::value_parser!(u16).range(1..))]
    count: u16,
    /// The impact for --models, --certificate, --line and --plot, numbered from 1.
    #[arg(long, value_name = "K", default_value_t = 1, value_parser = clap::value_parser!(u16).range(1..))]
    link: u16,
    /// Compare the impact models.
    #[arg(long)]
    models: bool,
    /// Compare with the largest restitution of any admissible motion, with any number of hinges.
    #[arg(long)]
    certificate: bool,
    /// Number of equal parts into which --certificate cuts an arch without voussoirs [default: 720].
    #[arg(long, value_name = "N", requires = "certificate", value_parser = clap::value_parser!(u16).range(12..=10_000))]
    joints: Option<u16>,
    /// Write the impulse line to this CSV file; `-` prints it instead of the chain.
    #[arg(long, value_name = "FILE")]
    line: Option<PathBuf>,
    /// Also draw the impact to this SVG file: mechanisms, bodies, impulse line.
    #[arg(long, value_name = "FILE")]
    plot: Option<PathBuf>,
    #[command(flatten)]
    figure: FigureOption,
    /// Output format.
    #[arg(long, value_enum, default_value_t)]
    format: Format,
}

impl Arguments {
    /// Whether an option for arches only is given.
    fn of_arches_only(&self) -> bool {
        self.models || self.certificate || self.line.is_some() || self.plot.is_some()
    }
}

/// The impact that was asked about.
struct Chosen<'a> {
    index: usize,
    before: &'a ArchLink,
    /// `None` when no mechanism can follow.
    after: Option<&'a ArchLink>,
}

pub fn impact(arguments: &Arguments) -> Result<(), Failure> {
    let scenario = arguments.scenario.open()?.read(None)?;
    let arch = match &scenario.structure {
        Structure::Column(_) | Structure::Masonry(_) if !arguments.of_arches_only() => {
            let model = commands::model(&scenario)?;
            let count = arguments.count.into();
            let (right, left) = (Sway::Right, Sway::Left);
            let both = matches!(scenario.structure, Structure::Masonry(_));
            return match arguments.format {
                Format::Json if both => print(&pretty(&json!({
                    "impacts": output::chain(&*model, right, count),
                    "impacts_after_left": output::chain(&*model, left, count),
                }))),
                Format::Json => print(&pretty(
                    &json!({ "impacts": output::chain(&*model, right, count) }),
                )),
                Format::Text => {
                    let mut text = chain_text(&scenario, &*model, right, count);
                    if both {
                        text.push('\n');
                        text += &chain_text(&scenario, &*model, left, count);
                    }
                    print(&text)
                }
            };
        }
        _ => commands::arch(&scenario, "--models, --certificate, --line and --plot are")?,
    };
    let chosen = || choose(&arch, arguments.link.into());
    if let Some(path) = &arguments.line {
        let others = arguments.models || arguments.certificate || arguments.plot.is_some();
        if path == Path::new("-") && others {
            return Err(Failure::Input(
                "--line - prints the impulse line only: drop --models, --certificate and --plot, or give \
                 --line a file"
                    .to_owned(),
            ));
        }
        write_line(path, &arch, &chosen()?)?;
        if path == Path::new("-") {
            return Ok(());
        }
    }
    if let Some(plot) = &arguments.plot {
        let picture = pictures::impact(arguments.figure.get(), arch.chain(), chosen()?.index);
        let picture = picture.ok_or_else(|| {
            Failure::Input(format!(
                "--plot: impact {} stops the arch; there is no mechanism after it to draw",
                arguments.link
            ))
        })?;
        commands::write_picture(plot, &picture)?;
    }
    let models = arguments
        .models
        .then(|| Ok::<_, Failure>(models(&scenario, &arch, &chosen()?)))
        .transpose()?;
    let certificate = arguments
        .certificate
        .then(|| certify(&arch, &chosen()?, arguments.joints))
        .transpose()?;
    let (count, link) = (usize::from(arguments.count), usize::from(arguments.link));
    match arguments.format {
        Format::Json => {
            let mut result = json!({ "impacts": output::impacts(&arch, count) });
            if let Some(models) = &models {
                result["models"] = output::models(&arch, link, models);
            }
            if let Some(projection) = &certificate {
                let after = chosen()?.after;
                result["certificate"] = output::certificate(&arch, link, after, projection);
            }
            print(&pretty(&result))
        }
        Format::Text => {
            let mut text = chain_text(&scenario, &arch, Sway::Right, count);
            text += &impulses_text(&arch, count);
            if let Some(models) = &models {
                text += &models_text(&arch, link, models);
            }
            if let Some(projection) = &certificate {
                text += &certificate_text(&scenario, &arch, &chosen()?, projection);
            }
            print(&text)
        }
    }
}

fn choose(arch: &FourLinkArch, index: usize) -> Result<Chosen<'_>, Failure> {
    let before = arch.chain().link(index - 1).ok_or_else(|| {
        Failure::Input(format!(
            "--link {index}: an earlier impact stops the arch; give a smaller number"
        ))
    })?;
    Ok(Chosen {
        index,
        before,
        after: arch.chain().link(index),
    })
}

fn write_line(path: &Path, arch: &FourLinkArch, chosen: &Chosen<'_>) -> Result<(), Failure> {
    let after = chosen.after.ok_or_else(|| {
        Failure::Input(format!(
            "--line: no mechanism can follow impact {}, so it has no impulse line",
            chosen.index
        ))
    })?;
    let line = after.impulse_line.as_ref().ok_or_else(|| {
        Failure::Input(
            "--line: a prescribed restitution coefficient has no impulse line; \
             choose another impact model in the scenario"
                .to_owned(),
        )
    })?;
    let write = |writer: &mut dyn io::Write| {
        output::write_line(writer, arch, chosen.index, &after.mechanism, line)
    };
    if path == Path::new("-") {
        return Ok(write(&mut io::stdout().lock())?);
    }
    let name = path.file_name().and_then(|name| name.to_str());
    let (Some(name), false) = (name, path.exists() && !path.is_file()) else {
        return Err(Failure::Input(format!(
            "--line {}: not a regular file; use - for standard output",
            path.display()
        )));
    };
    let parent = match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    };
    let mut folder = Folder::open(parent, &[name])
        .map_err(|error| Failure::Input(format!("{error}; choose another file with --line")))?;
    write(&mut folder.file(name))?;
    Ok(folder.complete()?)
}

/// The models that the momentum theorems govern, and a prescribed one if the scenario has it.
fn models(
    scenario: &Scenario,
    arch: &FourLinkArch,
    chosen: &Chosen<'_>,
) -> Vec<(ImpactModel, Option<Impact>)> {
    let mut models = vec![
        ImpactModel::MaxRestitution,
        ImpactModel::SameSections,
        ImpactModel::Mirrored,
    ];
    if !models.contains(&scenario.impact.model) {
        models.push(scenario.impact.model);
    }
    let (mechanism, chain) = (&chosen.before.mechanism, arch.chain());
    models
        .into_iter()
        .map(|model| {
            (
                model,
                impact_by(mechanism, chain.ring(), chain.sites(), model),
            )
        })
        .collect()
}

fn certify(
    arch: &FourLinkArch,
    chosen: &Chosen<'_>,
    joints: Option<u16>,
) -> Result<Projection, Failure> {
    let (ring, sites) = (arch.chain().ring(), arch.chain().sites());
    if let (HingeSites::Voussoirs(count), Some(_)) = (sites, joints) {
        return Err(Failure::Input(format!(
            "--joints: the arch has {count} voussoirs, whose joints are used; leave it out"
        )));
    }
    let joints = joints.map_or(DEFAULT_JOINTS, usize::from);
    let mechanism = chosen.after.map(|link| &link.mechanism);
    let joints_rad = joints_rad(ring, sites, joints, mechanism);
    let closing = closing_field(&chosen.before.mechanism, ring);
    project(&closing, ring, &joints_rad).map_err(|error| Failure::Work(error.to_string()))
}

/// The chain of mechanisms of any structure.
fn chain_text(
    scenario: &Scenario,
    model: &dyn MechanismModel,
    first: Sway,
    count: usize,
) -> String {
    let mut text = format!(
        "impacts after a first sway to the {}, model {}{} (r = kinetic energy after / before",
        first.name(),
        scenario.impact.model.name(),
        match scenario.impact.restitution_factor {
            1.0 => String::new(),
            factor => format!(" times {factor:?}"),
        },
    );
    let hinges = model.hinges_after(0, first);
    let of_arch = hinges.len() == 4;
    text += match hinges.first() {
        Some(Hinge::Section { .. }) => {
            ";\nangles in degrees from the left springing; I intrados, E extrados"
        }
        Some(Hinge::Joint { .. }) => {
            ";\njoints from the left, 0 at the left base or springing; I intrados, E extrados"
        }
        _ => "",
    };
    text += ")\n\nimpact         r  sway   ";
    let names: &[&str] = if of_arch {
        &commands::HINGES
    } else {
        &["turns about"]
    };
    for name in names {
        let _ = write!(text, "{name:>12}");
    }
    text.push('\n');
    for index in 0..=count {
        let Some(restitution) = model.restitution_from(first, index) else {
            let _ = writeln!(
                text,
                "{index:>6}  no mechanism can follow: the structure stops"
            );
            break;
        };
        let restitution = match index {
            0 => String::new(),
            _ => format!("{restitution:.6}"),
        };
        let sway = first.before(index);
        let _ = write!(text, "{index:>6}  {restitution:>8}  {:5}  ", sway.name());
        for hinge in model.hinges_after(index, sway) {
            let _ = match hinge {
                Hinge::Section { angle_rad, edge } => {
                    write!(text, "{:>10.5} {}", degrees(angle_rad), initial(edge))
                }
                Hinge::Toe(side) => write!(text, "{:>12}", format!("{} toe", side.name())),
                Hinge::Joint { joint, edge } => {
                    let edge = edge.map_or("", initial);
                    write!(text, "{:>12}", format!("joint {joint} {edge}"))
                }
            };
        }
        text.push('\n');
    }
    text
}

fn hinges(arch: &FourLinkArch, mechanism: &FourLink, sway: Sway) -> String {
    let mut text = String::new();
    for (angle_rad, edge) in mechanism.hinges_from_left(arch.chain().ring(), sway) {
        let _ = write!(text, "{:>10.5} {}", degrees(angle_rad), initial(edge));
    }
    text
}

fn initial(edge: Edge) -> &'static str {
    match edge {
        Edge::Intrados => "I",
        Edge::Extrados => "E",
    }
}

fn impulses_text(arch: &FourLinkArch, count: usize) -> String {
    let unit = arch.impulse_unit_n_s_per_m();
    let lines = || {
        (1..=count).map_while(|index| {
            let line = arch.chain().link(index)?.impulse_line.as_ref()?;
            Some((index, line))
        })
    };
    if lines().next().is_none() {
        return String::new();
    }
    let mut text =
        "\nimpulses at these hinges on the part towards the crown, x to the right and y up,\n\
                    in N s per metre of depth for a closing rate of 1 rad/s\n\nimpact"
            .to_owned();
    for hinge in ["A", "B", "C", "D"] {
        for component in ["x", "y"] {
            let _ = write!(text, "{:>11}", format!("{hinge} {component}"));
        }
    }
    text.push('\n');
    for (index, line) in lines() {
        let _ = write!(text, "{index:>6}");
        for impulse in line.hinge_impulses_from_left(output::sway(index)) {
            let _ = write!(
                text,
                "{:>11.5e}{:>11.5e}",
                impulse.x * unit,
                impulse.y * unit
            );
        }
        text.push('\n');
    }
    text += "\nimpulse line: eccentricity e (0.5 t is the edge), smallest normal impulse N in the same unit,\n\
             largest ratio of tangential impulse T to N, each with its section in degrees\n\n\
             impact      |e|/t   section        min N   section      |T|/N   section\n";
    for (index, line) in lines() {
        let extremes = line.extremes_from_left(arch.chain().sites(), output::sway(index));
        // Both are infinite where there is tension.
        let ratio = |extremum: Extremum| match extremum.value {
            value if value.is_finite() => format!("{value:>9.5}"),
            _ => format!("{:>9}", "-"),
        };
        let _ = writeln!(
            text,
            "{index:>6}  {}  {:>8.3}  {:>11.5e}  {:>8.3}  {}  {:>8.3}  {}",
            ratio(extremes.eccentricity_ratio),
            degrees(extremes.eccentricity_ratio.angle_rad),
            extremes.normal.value * unit,
            degrees(extremes.normal.angle_rad),
            ratio(extremes.friction_ratio),
            degrees(extremes.friction_ratio.angle_rad),
            verdict(&extremes),
        );
    }
    text
}

fn verdict(extremes: &Extremes) -> &'static str {
    if extremes.is_admissible() {
        "admissible"
    } else if extremes.normal.value <= 0.0 {
        "in tension"
    } else {
        "leaves the ring"
    }
}

fn models_text(
    arch: &FourLinkArch,
    index: usize,
    models: &[(ImpactModel, Option<Impact>)],
) -> String {
    let mut text = format!(
        "\nimpact models compared, impact {index}\n\n\
         model                    r   {:>12}{:>12}{:>12}{:>12}   impulse line\n",
        "A", "B", "C", "D"
    );
    let sway = output::sway(index);
    for (model, impact) in models {
        let _ = write!(text, "{:<16}", model.name());
        let Some(impact) = impact else {
            text += "  no mechanism can follow\n";
            continue;
        };
        let line = impact.impulse_line.as_ref().map_or("none", |line| {
            verdict(&line.extremes_from_left(arch.chain().sites(), sway))
        });
        let _ = writeln!(
            text,
            "{:>10.6}   {}   {line}",
            impact.restitution,
            hinges(arch, &impact.mechanism, sway)
        );
    }
    text
}

fn certificate_text(
    scenario: &Scenario,
    arch: &FourLinkArch,
    chosen: &Chosen<'_>,
    projection: &Projection,
) -> String {
    let four_link = chosen.after.map_or(0.0, |link| link.link.restitution);
    let gap = projection.restitution - four_link;
    let sway = output::sway(chosen.index);
    let mut text = format!(
        "\ncertificate of impact {}: largest restitution of any motion that opens joints and closes none\n\
         (any number of hinges; {} joints)\n\n\
         r, four hinges, model {:<16} {four_link:>12.8}\n\
         r, any number of hinges                {:>12.8}\n\
         gap                                    {gap:>12.8}\n\n",
        chosen.index,
        projection.joints.len(),
        scenario.impact.model.name(),
        projection.restitution,
    );
    if let Some(line) = chosen.after.and_then(|link| link.impulse_line.as_ref()) {
        let extremes = line.extremes_from_left(arch.chain().sites(), sway);
        let eccentricity = extremes.eccentricity_ratio;
        let _ = if extremes.is_admissible() {
            writeln!(
                text,
                "The impulse line of the four hinges is compressive and inside the ring: no admissible motion\n\
                 keeps more energy, so the four hinges are certified."
            )
        } else if extremes.normal.value <= 0.0 {
            writeln!(
                text,
                "The impulse line of the four hinges is in tension near {:.2} deg: more hinges keep more energy.",
                degrees(extremes.normal.angle_rad)
            )
        } else {
            writeln!(
                text,
                "The impulse line of the four hinges leaves the ring by {:.2} % of the thickness at {:.2} deg: \
                 other\nhinges keep more energy, {}.",
                100.0 * (eccentricity.value - 0.5),
                degrees(eccentricity.angle_rad),
                if gap > 1e-6 {
                    "by the gap above"
                } else {
                    "but these joints are too few to show it"
                }
            )
        };
    }
    if gap < -1e-6 {
        let _ = writeln!(
            text,
            "Model {} keeps more energy than any admissible motion can.",
            scenario.impact.model.name()
        );
    }
    if projection.opened().next().is_none() {
        text += "No motion keeps any energy: the impact stops the arch.\n";
        return text;
    }
    text += "The motion that keeps the most energy opens at, in degrees from the left springing\n";
    for zone in zones(arch, sway, projection) {
        let place = if zone.from_deg == zone.to_deg {
            format!("{:.3}", zone.from_deg)
        } else {
            format!("{:.3} to {:.3}", zone.from_deg, zone.to_deg)
        };
        let _ = writeln!(
            text,
            "  {place:>20}  {}  by {:.5} rad per rad of closing",
            initial(zone.edge),
            zone.rate
        );
    }
    text
}

/// Neighbouring joints of a continuous ring that open about the same edge, or a joint of voussoirs.
struct Zone {
    edge: Edge,
    from_deg: f64,
    to_deg: f64,
    /// Sum of their rotation rates.
    rate: f64,
    /// The last of them.
    joint: usize,
}

/// The zones that open, from the left springing.
fn zones(arch: &FourLinkArch, sway: Sway, projection: &Projection) -> Vec<Zone> {
    let mut zones: Vec<Zone> = Vec::new();
    for (joint, edge, rate) in projection.opened() {
        let angle_rad = projection.joints[joint].angle_rad;
        let angle_deg = degrees(sway.from_left(arch.chain().ring(), angle_rad));
        let continues = |zone: &&mut Zone| {
            arch.chain().sites() == HingeSites::Anywhere
                && zone.edge == edge
                && zone.joint + 1 == joint
        };
        match zones.iter_mut().find(continues) {
            Some(zone) => {
                zone.from_deg = zone.from_deg.min(angle_deg);
                zone.to_deg = zone.to_deg.max(angle_deg);
                zone.rate += rate;
                zone.joint = joint;
            }
            None => zones.push(Zone {
                edge,
                from_deg: angle_deg,
                to_deg: angle_deg,
                rate,
                joint,
            }),
        }
    }
    zones.sort_by(|a, b| a.from_deg.total_cmp(&b.from_deg));
    zones
}
