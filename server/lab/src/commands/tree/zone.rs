//! Zones as they are written on the command line.

use std::path::Path;
use std::str::FromStr;
use std::sync::Arc;

use anyhow::{Context, bail};
use sulcus_core::Vec3;
use sulcus_program::PathText;
use sulcus_scene::error::zone_patch;
use sulcus_scene::mesh::TriMesh;
use sulcus_scene::mesh::distance::MeshDistance;
use sulcus_scene::mesh::repair::Asked;
use sulcus_scene::mesh::size::Size;
use sulcus_scene::mesh::solid::{Reading, read_solid};
use sulcus_scene::tree::zone::{Region, Zone};

/// Name of a zone that was given none.
const UNNAMED: &str = "zone";

/// One `--zone`: `[NAME=]near:FILE:MM`, `[NAME=]ball:X,Y,Z,R` or `[NAME=]box:X,Y,Z,X,Y,Z`.
#[derive(Clone, Debug, PartialEq)]
pub struct ZoneArg {
    name: String,
    region: RegionArg,
}

/// A region, millimetres.
#[derive(Clone, Debug, PartialEq)]
enum RegionArg {
    Near { file: String, within: f64 },
    Ball([f64; 4]),
    Box([f64; 6]),
}

impl FromStr for ZoneArg {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (head, rest) = text.split_once(':').unwrap_or((text, ""));
        let (name, kind) = head.split_once('=').unwrap_or((UNNAMED, head));
        if name.is_empty() {
            return Err("its name is empty, expected NAME=KIND:... or KIND:...".to_owned());
        }
        let region = match kind {
            "near" => {
                let (file, within) = rest
                    .rsplit_once(':')
                    .filter(|(file, _)| !file.is_empty())
                    .ok_or(format!("found `near:{rest}`, expected near:FILE:MM"))?;
                let [within] = numbers(within, "near:FILE:MM")?;
                positive(within, "distance")?;
                RegionArg::Near {
                    file: file.to_owned(),
                    within,
                }
            }
            "ball" => {
                let ball: [f64; 4] = numbers(rest, "ball:X,Y,Z,R in mm")?;
                positive(ball[3], "radius")?;
                RegionArg::Ball(ball)
            }
            "box" => {
                let corners: [f64; 6] =
                    numbers(rest, "box:X,Y,Z,X,Y,Z in mm, lowest corner first")?;
                for axis in 0..3 {
                    positive(corners[axis + 3] - corners[axis], "side")?;
                }
                RegionArg::Box(corners)
            }
            other => {
                return Err(format!(
                    "its kind is `{other}`, expected near:FILE:MM, ball:X,Y,Z,R or box:X,Y,Z,X,Y,Z"
                ));
            }
        };
        Ok(Self {
            name: name.to_owned(),
            region,
        })
    }
}

fn numbers<const N: usize>(text: &str, expected: &str) -> Result<[f64; N], String> {
    let found: Option<Vec<f64>> = text
        .split(',')
        .map(|word| word.trim().parse().ok().filter(|x: &f64| x.is_finite()))
        .collect();
    found
        .and_then(|found| found.try_into().ok())
        .ok_or(format!("found `{text}`, expected {expected}"))
}

fn positive(x: f64, what: &str) -> Result<(), String> {
    if x > 0.0 {
        Ok(())
    } else {
        Err(format!("its {what} is {x} mm, expected more than 0"))
    }
}

/// The zones that were asked for; arguments of one name are one zone, the space that they share.
///
/// # Errors
/// If the mesh that a zone is near to cannot be used, or a zone holds nothing of the mesh.
pub(super) fn zones(
    arguments: &[ZoneArg],
    reading: Reading,
    mesh: &TriMesh,
    file: &Path,
) -> anyhow::Result<Vec<Zone>> {
    let mut zones: Vec<Zone> = Vec::new();
    for argument in arguments {
        let region = region(&argument.region, reading)?;
        match zones.iter_mut().find(|zone| zone.name == argument.name) {
            Some(zone) => zone.regions.push(region),
            None => zones.push(Zone {
                name: argument.name.clone(),
                regions: vec![region],
            }),
        }
    }
    for zone in &zones {
        if zone_patch(mesh, zone).triangles.is_empty() {
            bail!(
                "zone `{}` holds nothing of the surface of {}, expected a region that meets it (millimetres, in the mesh's own frame)",
                zone.name,
                file.shown()
            );
        }
    }
    Ok(zones)
}

fn region(argument: &RegionArg, reading: Reading) -> anyhow::Result<Region> {
    Ok(match argument {
        RegionArg::Near { file, within } => {
            // Another mesh in the same unit, which may be of another kind.
            let other = Reading {
                size: match reading.size {
                    Size::Any => Size::Any,
                    _ => Size::Mouth,
                },
                asked: Asked::default(),
                ..reading
            };
            let other = read_solid(Path::new(file), other).context("--zone near")?;
            Region::Near {
                mesh: Arc::new(MeshDistance::new(other.mesh)),
                within: 1e-3 * within,
            }
        }
        RegionArg::Ball([x, y, z, radius]) => Region::Ball {
            centre: Vec3::new(*x, *y, *z) * 1e-3,
            radius: 1e-3 * radius,
        },
        RegionArg::Box([x, y, z, far_x, far_y, far_z]) => Region::Box {
            low: Vec3::new(*x, *y, *z) * 1e-3,
            high: Vec3::new(*far_x, *far_y, *far_z) * 1e-3,
        },
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn zones_are_read_as_they_are_written() {
        let zone = |text: &str| text.parse::<ZoneArg>().expect("a zone");
        assert_eq!(
            zone("near:a:b.stl:0.6"),
            ZoneArg {
                name: "zone".into(),
                region: RegionArg::Near {
                    file: "a:b.stl".into(),
                    within: 0.6
                }
            }
        );
        assert_eq!(zone("tip=ball:1, -2,3.5,0.25").name, "tip");
        assert_eq!(
            zone("tip=ball:1, -2,3.5,0.25").region,
            RegionArg::Ball([1.0, -2.0, 3.5, 0.25])
        );
        // An equals sign in a file's name is no zone's name.
        assert_eq!(zone("near:x=y.stl:1").name, "zone");
        assert_eq!(
            zone("box:0,0,0,1,2,3").region,
            RegionArg::Box([0.0, 0.0, 0.0, 1.0, 2.0, 3.0])
        );
    }

    #[test]
    fn what_is_not_a_zone_is_refused_with_what_was_found_and_expected() {
        for (text, told) in [
            ("cone:1", "kind is `cone`, expected near:"),
            ("", "kind is ``"),
            ("near:0.6", "expected near:FILE:MM"),
            ("near:a.stl:x", "found `x`"),
            ("near:a.stl:-1", "distance is -1 mm, expected more than 0"),
            ("ball:1,2,3", "found `1,2,3`, expected ball:X,Y,Z,R"),
            ("ball:1,2,3,0", "radius is 0 mm"),
            ("ball:1,2,NaN,1", "found `1,2,NaN,1`"),
            ("box:0,0,0,1,1,0", "side is 0 mm"),
            ("=ball:0,0,0,1", "name is empty"),
        ] {
            let error = text.parse::<ZoneArg>().expect_err(text);
            assert!(error.contains(told), "{text}: {error}");
        }
    }
}
