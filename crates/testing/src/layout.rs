//! Layouts of elements: scattered with occlusion, packed without overlap, or as cells with gaps.

use super::noise::fractal;
use super::render::{Canvas, PlacedShape};
use super::scenes::Composition;
use super::shapes::{LocalOutline, centroid, clip, polygon_area};
use vtex_base::sampling::Stream;

/// Radius of the smallest cell kept: about 30 square pixels.
const SMALLEST: f32 = 3.1;

/// How elements are arranged.
#[derive(Clone, Copy, Debug)]
pub(super) enum ElementLayout {
    /// Random positions, later elements below earlier ones (dead leaves). `cluster` 0 is even, 1 clustered.
    Scatter { cluster: f32 },
    /// No overlap, at least `gap` pixels apart: large elements first, small ones in the remaining gaps.
    Packed { gap: f32 },
    /// Cells of a power diagram, shrunk by about `gap` pixels.
    Cells { gap: f32 },
}

/// Draws elements until they cover the requested share, or no further one fits.
pub(super) fn place(scene: &Composition, coverage: f64, canvas: &mut Canvas, random: &mut Stream) {
    if coverage <= 0.0 {
        return;
    }
    match scene.layout {
        ElementLayout::Scatter { cluster } => scatter(scene, coverage, cluster, 1, canvas, random),
        ElementLayout::Packed { gap } => packed(scene, coverage, gap, canvas, random),
        ElementLayout::Cells { gap } => cells(scene, coverage, gap, canvas, random),
    }
}

fn scatter(
    scene: &Composition,
    coverage: f64,
    cluster: f32,
    first: u32,
    canvas: &mut Canvas,
    random: &mut Stream,
) {
    let pixels = (canvas.width * canvas.height) as f64;
    let attempts = 500 + (12.0 * pixels / f64::from(scene.radius[0] * scene.radius[0])) as usize;
    let seed = random.bits() as u32;
    let wavelength = 4.0 * scene.radius[1] + 20.0;
    let mut label = first;
    for _ in 0..attempts {
        if canvas.coverage() >= coverage {
            break;
        }
        let radius = scene.draw_radius(random);
        let centre = anywhere(canvas, radius, random);
        let density = 0.5 + fractal(centre[0] / wavelength, centre[1] / wavelength, 2, seed);
        if random.unit() < f64::from(cluster * (1.0 - 1.6 * density)) {
            continue;
        }
        let mut parts = scene.draw_kind(random).make(radius, label, random);
        // Deeper elements receive less light.
        let light = 1.0 - scene.depth * (canvas.coverage() / coverage) as f32;
        parts.iter_mut().for_each(|part| part.fill.darken(light));
        draw(scene, canvas, parts, centre);
        label += 1;
    }
}

fn packed(scene: &Composition, coverage: f64, gap: f32, canvas: &mut Canvas, random: &mut Stream) {
    let pixels = (canvas.width * canvas.height) as f64;
    let mut wanted = 1.05 * coverage * pixels;
    let mut radii = Vec::new();
    while wanted > 0.0 {
        let radius = scene.draw_radius(random);
        wanted -= std::f64::consts::PI * f64::from(radius * radius);
        radii.push(radius);
    }
    radii.sort_by(|a, b| b.total_cmp(a));
    let mut label = 1;
    for radius in radii {
        if canvas.coverage() >= coverage {
            return;
        }
        label += u32::from(settle(scene, radius, label, gap, 24, canvas, random));
    }
    fill_gaps(scene, coverage, gap, label, canvas, random);
}

/// Places small elements in the remaining gaps.
fn fill_gaps(
    scene: &Composition,
    coverage: f64,
    gap: f32,
    first: u32,
    canvas: &mut Canvas,
    random: &mut Stream,
) {
    let pixels = (canvas.width * canvas.height) as f64;
    let mut label = first;
    for _ in 0..(0.6 * pixels / f64::from(scene.radius[0] * scene.radius[0])) as usize {
        if canvas.coverage() >= coverage {
            return;
        }
        let radius = scene.radius[0] * random.range(1.0, 1.8) as f32;
        label += u32::from(settle(scene, radius, label, gap, 6, canvas, random));
    }
}

/// Tries random places for an element of about the given radius, occasionally shrinking it.
fn settle(
    scene: &Composition,
    radius: f32,
    label: u32,
    gap: f32,
    tries: u32,
    canvas: &mut Canvas,
    random: &mut Stream,
) -> bool {
    let kind = scene.draw_kind(random);
    let mut radius = radius;
    for round in 0..3 {
        let parts = kind.make(radius, label, random);
        for _ in 0..tries {
            let centre = anywhere(canvas, radius * 0.7, random);
            if !canvas.is_open(centre) {
                continue;
            }
            let moved: bool = parts.iter().all(|part| {
                let mut part = part.clone();
                part.centre = [part.centre[0] + centre[0], part.centre[1] + centre[1]];
                canvas.fits(&part, gap)
            });
            if moved {
                draw(scene, canvas, parts, centre);
                return true;
            }
        }
        radius = (radius * 0.75).max(scene.radius[0]);
        if round > 0 && radius <= scene.radius[0] {
            break;
        }
    }
    false
}

fn cells(scene: &Composition, coverage: f64, gap: f32, canvas: &mut Canvas, random: &mut Stream) {
    let sites = SpacedPoints::throw(scene, canvas, random);
    let mut order: Vec<usize> = (0..sites.points.len()).collect();
    random.shuffle(&mut order);
    for (k, &i) in order.iter().enumerate() {
        if canvas.coverage() >= coverage {
            return;
        }
        let gap = (gap * random.range(0.5, 1.6) as f32).min(0.3 * sites.points[i][2]);
        let mut corners = sites.cell(i, 0.5 * gap);
        // Cuts off corners, because stones are not perfect cells.
        for _ in 0..random.below(3) {
            let (angle, offset) = (random.range(0.0, std::f64::consts::TAU), random.range(0.75, 1.2));
            let offset = offset as f32 * sites.points[i][2];
            clip(&mut corners, [libm::cos(angle) as f32, libm::sin(angle) as f32, offset]);
        }
        if corners.len() < 3 {
            continue;
        }
        let middle = centroid(&corners);
        let local: Vec<[f32; 2]> = corners.iter().map(|c| [c[0] - middle[0], c[1] - middle[1]]).collect();
        let radius = (polygon_area(&local).max(0.0) / std::f32::consts::PI).sqrt();
        if radius < SMALLEST {
            continue;
        }
        let rounding = radius * random.range(0.05, 0.35) as f32;
        if let Some(shape) = LocalOutline::polygon(&local, rounding) {
            let element = scene.draw_kind(random).fill(shape, radius, k as u32 + 1, random);
            let at = sites.points[i];
            draw(scene, canvas, vec![element], [at[0] + middle[0], at[1] + middle[1]]);
        }
    }
    // Elements that throw shadows lie on top of others; flat ones have small ones between them.
    let first = order.len() as u32 + 1;
    if scene.shadow.is_some() {
        scatter(scene, coverage, 0.0, first, canvas, random);
    } else {
        fill_gaps(scene, coverage, 0.5 * gap, first, canvas, random);
    }
}

/// Points with radii, and a grid for neighbour queries.
struct SpacedPoints {
    points: Vec<[f32; 3]>,
    grid: Vec<Vec<usize>>,
    cell: f32,
    columns: usize,
    rows: usize,
    reach: f32,
}

impl SpacedPoints {
    /// Random points, none within the sum of the radii (slightly reduced) of another.
    fn throw(scene: &Composition, canvas: &Canvas, random: &mut Stream) -> Self {
        let reach = 1.05 * scene.radius[1];
        let cell = (2.0 * scene.radius[0]).max(4.0);
        let (width, height) = (canvas.width as f32 + 2.0 * reach, canvas.height as f32 + 2.0 * reach);
        let (columns, rows) = ((width / cell) as usize + 1, (height / cell) as usize + 1);
        let grid = vec![Vec::new(); columns * rows];
        let mut sites = Self { points: Vec::new(), grid, cell, columns, rows, reach };
        let attempts = (4.0 * width * height / (scene.radius[0] * scene.radius[0])).min(60_000.0) as usize;
        let (mut failed, mut scale) = (0, 1.0f32);
        for _ in 0..attempts {
            // Gaps reduce the cells; smaller sites would leave none.
            let radius = (scene.draw_radius(random) * scale).max(scene.radius[0]).max(1.3 * SMALLEST);
            let p = [
                random.range(0.0, f64::from(width)) as f32 - reach,
                random.range(0.0, f64::from(height)) as f32 - reach,
            ];
            let crowded = sites.near(p, 0.9 * (radius + reach)).any(|j| {
                let q = sites.points[j];
                let (dx, dy, apart) = (p[0] - q[0], p[1] - q[1], 0.9 * (radius + q[2]));
                dx * dx + dy * dy < apart * apart
            });
            if crowded {
                failed += 1;
                if failed % 12 == 0 {
                    // No room for large sites any more: the following ones are smaller.
                    scale = (scale * 0.96).max(scene.radius[0] / scene.radius[1]);
                }
                if failed > 400
                    && scale * scene.radius[1] <= scene.radius[0] * 1.01
                    && failed > 6 * sites.points.len()
                {
                    break;
                }
                continue;
            }
            let at = sites.bucket(p);
            sites.grid[at].push(sites.points.len());
            sites.points.push([p[0], p[1], radius]);
        }
        sites
    }

    fn bucket(&self, p: [f32; 2]) -> usize {
        let x = (((p[0] + self.reach) / self.cell) as usize).min(self.columns - 1);
        let y = (((p[1] + self.reach) / self.cell) as usize).min(self.rows - 1);
        y * self.columns + x
    }

    /// Sites in the grid cells within `distance` of a point.
    fn near(&self, p: [f32; 2], distance: f32) -> impl Iterator<Item = usize> + '_ {
        let low = self.bucket([p[0] - distance, p[1] - distance]);
        let high = self.bucket([p[0] + distance, p[1] + distance]);
        let (x0, x1, columns) = (low % self.columns, high % self.columns, self.columns);
        (low / columns..=high / columns)
            .flat_map(move |y| (x0..=x1).flat_map(move |x| self.grid[y * columns + x].iter().copied()))
    }

    /// Corners of a site's power cell relative to the site, with all sides moved inwards by `inset`.
    fn cell(&self, i: usize, inset: f32) -> Vec<[f32; 2]> {
        let [x, y, r] = self.points[i];
        let far = 2.2 * r + 4.0;
        let mut corners = vec![[-far, -far], [far, -far], [far, far], [-far, far]];
        for j in self.near([x, y], 2.0 * far) {
            let [qx, qy, qr] = self.points[j];
            let (dx, dy) = (qx - x, qy - y);
            let distance = (dx * dx + dy * dy).sqrt();
            if j != i && distance > 1e-3 {
                let middle = 0.5 * (distance + 0.6 * (r * r - qr * qr) / distance);
                clip(&mut corners, [dx / distance, dy / distance, middle - inset]);
            }
        }
        corners
    }
}

/// A random point of the canvas, widened by `margin`.
fn anywhere(canvas: &Canvas, margin: f32, random: &mut Stream) -> [f32; 2] {
    let mut along =
        |length: usize| random.range(f64::from(-margin), length as f64 + f64::from(margin)) as f32;
    [along(canvas.width), along(canvas.height)]
}

fn draw(scene: &Composition, canvas: &mut Canvas, parts: Vec<PlacedShape>, centre: [f32; 2]) {
    for mut part in parts {
        part.centre = [part.centre[0] + centre[0], part.centre[1] + centre[1]];
        canvas.draw(&part, scene.shadow.as_ref());
    }
}

/// Draws unlabelled vegetation below everything drawn so far, up to `amount` times the canvas' area.
pub(super) fn grow(scene: &Composition, amount: f64, canvas: &mut Canvas, random: &mut Stream) {
    if scene.growth.is_empty() {
        return;
    }
    let area = std::f64::consts::PI * f64::from(scene.growth_radius * scene.growth_radius);
    let count = (amount * (canvas.width * canvas.height) as f64 / area) as usize;
    for k in 0..count {
        if canvas.openness() < 0.003 {
            return;
        }
        let radius = scene.growth_radius * random.range(0.6, 1.4) as f32;
        let centre = anywhere(canvas, radius, random);
        let mut parts = scene.growth[random.index(scene.growth.len())].make(radius, 0, random);
        for part in &mut parts {
            part.fill.darken(1.0 - 0.8 * k as f32 / count as f32);
            part.centre = [part.centre[0] + centre[0], part.centre[1] + centre[1]];
            canvas.draw(part, None);
        }
    }
}
