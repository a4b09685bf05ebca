//! Lattices: translations under which a picture looks the same.
//!
//! A picture has rows, such as planks or courses of uneven bricks, or a lattice, such as tiles or a tread plate. Both
//! are found from its autocorrelation ([`find`](mod@find)), and both say the *phase* of a place: its position within a
//! period.

mod cells;
mod correlation;
mod find;
mod fit;
mod maps;
mod rows;
#[cfg(test)]
mod tests;

pub use find::{find, of_period};

#[cfg(feature = "schema")]
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use vtex_base::error::{Error, Result};

/// Largest relative change of a lattice's vectors that makes its periods fit a canvas.
const MOST_STRETCH: f64 = 0.03;
/// The same for proposed sizes: below the limit, because sizes are rounded.
const PROPOSED_STRETCH: f64 = 0.027;
/// Least angle between two vectors: its sine.
const LEAST_SINE: f64 = 0.2;
/// Largest stray of a lattice that textures follow by default, as a share of its shortest vector: farther astray are
/// things that are regular in parts only, such as paving in fans.
const KEPT: f64 = 0.05;
/// Angles up to this are level, in degrees.
const LEVEL: f64 = 3.0;
/// Shortest vector, in pixels.
const SHORTEST: f64 = 4.0;

/// Translations under which an exemplar looks the same.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Lattice {
    /// One vector, in pixels: rows across it, free along the direction at right angles to it. Two: a lattice.
    pub vectors: Vec<[f64; 2]>,
    /// Correlation of the exemplar with itself moved by whole periods, 0 to 1: of its colours or of its edges,
    /// whichever shows the lattice more clearly. A floor of tiles in many colours has little and is regular all the same.
    pub strength: f64,
    /// Standard deviation of the peaks of that correlation from the lattice, in pixels.
    pub stray: f64,
}

impl Lattice {
    /// A lattice of given vectors, one or two, in pixels.
    ///
    /// # Errors
    /// [`Error::Parameter`] unless each is at least 4 pixels long and two are far from parallel.
    pub fn new(vectors: &[[f64; 2]]) -> Result<Self> {
        let lattice = Self { vectors: vectors.to_vec(), strength: 1.0, stray: 0.0 };
        match lattice.fault() {
            None => Ok(lattice),
            Some(_) => Err(Error::Parameter {
                name: "lattice",
                value: vectors.iter().flatten().map(f64::to_string).collect::<Vec<_>>().join(","),
                allowed: "one or two vectors of at least 4 pixels, in different directions".into(),
            }),
        }
    }

    /// Whether textures follow it by default: only if its stray is at most a twentieth of its shortest vector.
    pub fn is_kept(&self) -> bool {
        let shortest = self.vectors.iter().map(|v| length(*v)).fold(f64::INFINITY, f64::min);
        self.stray <= KEPT * shortest
    }

    /// The lattice as people see it, such as "rows every 57 px, in each a period of 79 px, moved by a half from row to
    /// row".
    pub fn in_words(&self) -> String {
        const NAMES: [[&str; 2]; 2] = [["rows", "row"], ["columns", "column"]];
        match self.vectors[..] {
            [a, b] => {
                let in_rows = || (0..2).find_map(|along| rows_in_words([a, b], along, NAMES[along]));
                let free = || {
                    format!("a lattice that repeats every {:.0} px and every {:.0} px", length(a), length(b))
                };
                in_rows().unwrap_or_else(free)
            }
            _ => {
                let [x, y] = self.vectors.first().map_or([0.0; 2], |v| fit::forward(*v));
                let every = libm::hypot(x, y);
                match libm::round(libm::atan2(x, y).to_degrees()) {
                    turn if turn.abs() <= LEVEL => format!("rows every {every:.0} px"),
                    turn if (turn.abs() - 90.0).abs() <= LEVEL => format!("columns every {every:.0} px"),
                    turn => format!("rows every {every:.0} px, turned by {turn:.0}°"),
                }
            }
        }
    }

    /// Why the lattice is invalid; `None` if it is valid.
    pub(crate) fn fault(&self) -> Option<String> {
        if !(1..=2).contains(&self.vectors.len()) {
            return Some(format!("has {} vectors, not 1 or 2", self.vectors.len()));
        }
        if !self.vectors.iter().all(|v| (SHORTEST..=1e5).contains(&length(*v))) {
            return Some("has a vector that is not within 4 to 100000 pixels".into());
        }
        if let [a, b] = self.vectors[..]
            && cross(a, b).abs() < LEAST_SINE * length(a) * length(b)
        {
            return Some("has two vectors in nearly the same direction".into());
        }
        let sound = (0.0..=1.0).contains(&self.strength) && (0.0..=1e5).contains(&self.stray);
        (!sound).then(|| "has a strength or stray out of range".into())
    }

    /// The lattice with lengths along x and y multiplied.
    pub(crate) fn scaled(&self, by: [f64; 2]) -> Self {
        let vectors = self.vectors.iter().map(|v| [v[0] * by[0], v[1] * by[1]]).collect();
        Self { vectors, stray: self.stray * libm::sqrt(by[0] * by[1]), ..*self }
    }

    /// The phases of places in the exemplar.
    pub fn phases(&self) -> Phases {
        let waves = match self.vectors[..] {
            [a, b] => {
                let d = cross(a, b);
                vec![[b[1] / d, -b[0] / d], [-a[1] / d, a[0] / d]]
            }
            _ => self.vectors.iter().map(|a| a.map(|c| c / dot(*a, *a))).collect(),
        };
        Phases { waves }
    }

    /// Whether whole periods fit a canvas of `size` pixels that repeats along the axes of `wrap`: see
    /// [`Lattice::phases_of_tile`].
    pub fn fits_tile(&self, size: [u32; 2], wrap: [bool; 2]) -> bool {
        self.strain(size.map(f64::from), wrap) <= MOST_STRETCH
    }

    /// The waves, stretched so that whole periods fit a canvas.
    fn fitted(&self, size: [f64; 2], wrap: [bool; 2]) -> Vec<[f64; 2]> {
        let whole = |w: f64, k: usize| if wrap[k] { libm::round(w * size[k]) / size[k] } else { w };
        self.phases().waves.iter().map(|w| [whole(w[0], 0), whole(w[1], 1)]).collect()
    }

    /// Largest displacement of a vector where whole periods fit a canvas, as a share of its length.
    fn strain(&self, size: [f64; 2], wrap: [bool; 2]) -> f64 {
        let waves = self.phases().waves;
        let fitted = self.fitted(size, wrap);
        let missed = |v: &[f64; 2]| {
            let phase =
                fitted.iter().zip(&waves).map(|(f, w)| [f[0] - w[0], f[1] - w[1]]).map(|d| dot(d, *v));
            libm::sqrt(self.residual_of(&phase.collect::<Vec<_>>())) / libm::sqrt(dot(*v, *v))
        };
        self.vectors.iter().map(missed).fold(0.0, f64::max)
    }

    /// [`Lattice::phases`] of a canvas of `size` pixels that repeats along the axes of `wrap`: stretched a
    /// little, so that whole periods fit.
    ///
    /// # Errors
    /// [`Error::Parameter`] if that changes the vectors by more than 3 %; it names the nearest sizes that fit.
    pub fn phases_of_tile(&self, size: [u32; 2], wrap: [bool; 2]) -> Result<Phases> {
        let strain = |size: [f64; 2]| self.strain(size, wrap);
        let size = size.map(f64::from);
        if strain(size) <= MOST_STRETCH {
            return Ok(Phases { waves: self.fitted(size, wrap) });
        }
        // The nearest size, and the nearest larger one, whose periods fit.
        let fits = |w: f64, h: f64| w >= 1.0 && h >= 1.0 && strain([w, h]) <= PROPOSED_STRETCH;
        let reach = |k: usize| if wrap[k] { (size[k] / 2.0) as i32 } else { 0 };
        let steps = |most: i32| (0..=most).flat_map(|d| [d, -d]);
        let near = steps(reach(0))
            .map(f64::from)
            .flat_map(|dx| steps(reach(1)).take(160).map(f64::from).map(move |dy| [dx, dy]));
        let nearest = near
            .take(200_000)
            .filter(|d| fits(size[0] + d[0], size[1] + d[1]))
            .min_by(|a, b| dot(*a, *a).total_cmp(&dot(*b, *b)));
        Err(Error::Periods {
            width: size[0] as u32,
            height: size[1] as u32,
            nearest: nearest.map(|d| [0, 1].map(|k| (size[k] + d[k]) as u32)),
        })
    }

    /// The offset from a place of a canvas to the nearest place with the phase of a place of the exemplar.
    pub fn residual(&self, canvas: &Phases, exemplar: [f64; 2], place: [f64; 2]) -> [f64; 2] {
        let mut way = [0.0; 2];
        for ((wave, on_canvas), vector) in self.phases().waves.iter().zip(&canvas.waves).zip(&self.vectors) {
            let phase = dot(*wave, exemplar) - dot(*on_canvas, place);
            (0..2).for_each(|k| way[k] += (phase - libm::round(phase)) * vector[k]);
        }
        way
    }

    /// Squared distance in pixels for differences of phase, each from -0.5 to 0.5.
    fn residual_of(&self, phases: &[f64]) -> f64 {
        let mut sum = [0.0; 2];
        for (phase, v) in phases.iter().zip(&self.vectors) {
            (0..2).for_each(|k| sum[k] += phase * v[k]);
        }
        dot(sum, sum)
    }
}

/// A lattice as rows along an axis, or columns; `None` if no short vector of it runs along that axis.
fn rows_in_words([a, b]: [[f64; 2]; 2], along: usize, [rows, row]: [&str; 2]) -> Option<String> {
    /// Offsets that have a name, and how near to them others have it too.
    const SHARES: [(f64, &str); 4] = [(0.5, "half"), (1.0 / 3.0, "third"), (0.25, "quarter"), (0.2, "fifth")];
    const NEAR: f64 = 0.03;
    let sums =
        [[1.0, 0.0], [0.0, 1.0], [1.0, 1.0], [1.0, -1.0], [2.0, 1.0], [1.0, 2.0], [2.0, -1.0], [1.0, -2.0]];
    let is_level = |v: &[f64; 2]| v[1 - along].abs() <= libm::tan(LEVEL.to_radians()) * v[along].abs();
    let period = sums.map(|by| fit::sum([a, b], by)).into_iter().find(is_level)?;
    let (every, apart) = (length(period), cross(a, b).abs() / length(period));
    // How far the next row is moved along, in periods, 0 to a half.
    let other = if cross(period, a).abs() > cross(period, b).abs() * 0.5 { a } else { b };
    let rows_on = libm::round(cross(period, other).abs() / cross(a, b).abs()).max(1.0);
    let moved = dot(other, period) / dot(period, period);
    let moved = if rows_on > 1.0 { moved / rows_on } else { moved };
    let moved = (moved - libm::round(moved)).abs();
    if moved <= NEAR {
        let across = if along == 0 { "columns" } else { "rows" };
        return Some(format!("{rows} every {apart:.0} px and {across} every {every:.0} px"));
    }
    let share = SHARES.iter().find(|(share, _)| (share - moved).abs() <= NEAR);
    let by = share.map_or_else(|| format!("{:.0} px", moved * every), |(_, name)| format!("a {name}"));
    Some(format!(
        "{rows} every {apart:.0} px, in each a period of {every:.0} px, moved by {by} from {row} to {row}"
    ))
}

/// Phases of places: their distances from the origin along each vector, in periods.
#[derive(Clone, Debug, PartialEq)]
pub struct Phases {
    /// The reciprocal of each vector of the lattice: their scalar product is 1, that with the other vector 0.
    pub waves: Vec<[f64; 2]>,
}

pub(crate) fn dot(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

pub(crate) fn cross(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[1] - a[1] * b[0]
}

pub(crate) fn length(v: [f64; 2]) -> f64 {
    libm::hypot(v[0], v[1])
}
