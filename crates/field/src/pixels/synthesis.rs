//! Pixel-by-pixel synthesis from coarse to fine (Wei and Levoy).
//!
//! A pixel gets the exemplar pixel with the most similar neighbourhood: one of the nearest leaf of the codebook,
//! or one that continues the source of an adjacent pixel (Ashikhmin 2001). Pixels that are not known yet count
//! nothing in a neighbourhood. A level starts with the finer pixels of the coarser level's sources; scans then
//! improve it, every second one backwards. Around given pixels they go outwards, so no side of a hole is left
//! to the end.

use super::colour_use::{ColourUse, match_colours};
use super::neighbourhood::{KnownNeighbourhoods, Neighbourhood, NeighbourhoodVector, complete};
use super::pyramid::PictureLevel;
use super::scan::ScanParams;
use super::tsvq::distance_of_known;
use vtex_base::error::Result;
use vtex_base::progress::{Progress, advance};
use vtex_base::raster::squared_distance;
use vtex_base::sampling::{Stream, stream};

/// Scans of the coarsest level, where structure is formed, and of the others.
const SCANS: [usize; 2] = [4, 2];
/// Complete neighbourhoods that the coarsest level has at least.
pub(super) const LEAST_COMPLETE: usize = 64;
/// Offsets to the pixels whose sources may be continued.
const AROUND: [[i64; 2]; 8] = [[-1, 0], [0, -1], [-1, -1], [1, -1], [1, 0], [0, 1], [-1, 1], [1, 1]];

/// What is to be made.
pub(super) struct ScanRequest<'a> {
    pub(super) exemplar: PictureLevel,
    /// Its unknown pixels are made.
    pub(super) canvas: PictureLevel,
    pub(super) params: &'a ScanParams,
    /// Whether the pixels made are to have the exemplar's distribution of colours.
    pub(super) keeps_colours: bool,
    pub(super) seed: u64,
}

/// The exemplar pixel for each unknown pixel of the canvas.
pub(super) fn sources(request: ScanRequest<'_>, progress: &dyn Progress) -> Result<Vec<u32>> {
    let ScanRequest { exemplar, canvas, params, keeps_colours, seed } = request;
    let reach = (params.neighbourhood / 2) as i64;
    let levels = pyramids(exemplar, canvas, params, progress);
    let scans = |level: usize| SCANS[usize::from(level + 1 < levels.len())];
    // A codebook counts as one scan.
    let total = (0..levels.len()).map(|l| ((scans(l) + 1) * levels[l].1.size[1]) as u64).sum();
    let mut done = 0;
    let mut coarser: Option<PictureLevel> = None;
    let mut sources: Vec<Option<u32>> = Vec::new();
    for level in (0..levels.len()).rev() {
        let (exemplar, canvas) = &levels[level];
        let above = levels.get(level + 1).map(|(exemplar, _)| exemplar);
        let form = Neighbourhood::new(exemplar, reach);
        let complete = complete(exemplar, above, reach);
        let labels = (0..canvas.pixels.len()).map(|i| canvas.label(i)).max().unwrap_or(0) + 1;
        let mut books = Vec::new();
        for label in 0..labels {
            let wanted = (0..canvas.pixels.len()).any(|i| !canvas.known[i] && canvas.label(i) == label);
            let mut go_on = || advance(progress, "pixels", done, total);
            let book = wanted.then(|| {
                let codewords = params.codebook;
                KnownNeighbourhoods::new(&form, exemplar, above, &complete, label, codewords, &mut go_on)
            });
            books.push(book.transpose()?);
        }
        done += canvas.size[1] as u64;
        let mut random = stream(seed, "pixels/noise", level as u64);
        let orders = orders(canvas, coarser.is_none(), &mut random);
        let all_labels = exemplar.labels.iter().flat_map(|map| &map.labels).max().map_or(1, |l| l + 1);
        let mut scan = LevelScan {
            exemplar,
            above,
            form: &form,
            complete: &complete,
            books,
            coarser: coarser.as_ref(),
            made: canvas.clone(),
            sources: vec![None; canvas.pixels.len()],
            colour_use: keeps_colours.then(|| ColourUse::new(exemplar, all_labels.max(labels) as usize)),
            vector: NeighbourhoodVector::default(),
            candidate: NeighbourhoodVector::default(),
        };
        scan.start(&sources);
        for k in 0..scans(level) {
            for (step, i) in orders[k % 2].iter().enumerate() {
                if step % canvas.size[0] == 0 {
                    advance(progress, "pixels", done + (step / canvas.size[0]) as u64, total)?;
                }
                scan.make(*i, &mut random);
            }
            done += canvas.size[1] as u64;
        }
        let mut made = scan.made;
        if level > 0 && keeps_colours {
            match_colours(&mut made, &orders[0], exemplar, labels);
        }
        sources = scan.sources;
        coarser = Some(made);
    }
    Ok(sources.into_iter().map(Option::unwrap_or_default).collect())
}

/// The levels of exemplar and canvas, from the finest: as many as are wanted and have enough neighbourhoods.
fn pyramids(
    exemplar: PictureLevel,
    canvas: PictureLevel,
    params: &ScanParams,
    progress: &dyn Progress,
) -> Vec<(PictureLevel, PictureLevel)> {
    let wanted = params.levels.unwrap_or(ScanParams::MOST_DEFAULT_LEVELS);
    let reach = (params.neighbourhood / 2) as i64;
    let count = |level: &PictureLevel, coarser: Option<&PictureLevel>| {
        complete(level, coarser, reach).into_iter().filter(|complete| *complete).count()
    };
    if params.codebook > ScanParams::CODEBOOK.default() {
        let most = count(&exemplar, None).max(1);
        if params.codebook > most {
            progress.warn(&format!("the codebook has {most} codewords, as many as there are neighbourhoods"));
        }
    }
    let mut levels = vec![(exemplar, canvas)];
    while levels.len() < wanted {
        let (exemplar, canvas) = &levels[levels.len() - 1];
        let next = (exemplar.halved(), canvas.halved());
        let is_small = next.1.size.iter().any(|&v| v < params.neighbourhood);
        let counts = [count(&next.0, None), count(exemplar, Some(&next.0))];
        if is_small || counts.iter().any(|&count| count < LEAST_COMPLETE) {
            break;
        }
        levels.push(next);
    }
    if params.levels.is_some_and(|wanted| wanted > levels.len()) {
        let count = levels.len();
        progress.warn(&format!(
            "{count} level{} in place of {wanted}: coarser ones would have too few neighbourhoods",
            if count == 1 { "" } else { "s" }
        ));
    }
    levels
}

/// The unknown pixels in the order of the first scan and in that of the second. Outwards from known ones; on the
/// coarsest level without any at random, on others row by row.
fn orders(canvas: &PictureLevel, is_coarsest: bool, random: &mut Stream) -> [Vec<usize>; 2] {
    let mut order: Vec<usize> = (0..canvas.pixels.len()).filter(|&i| !canvas.known[i]).collect();
    if is_coarsest || order.len() < canvas.pixels.len() {
        let far = squared_distance(canvas.size[0], canvas.size[1], |i| canvas.known[i]);
        // Distances are not negative, so their bits sort like their values.
        order.sort_by_cached_key(|&i| (far[i].to_bits(), random.index(1 << 30)));
    }
    let back = order.iter().rev().copied().collect();
    [order, back]
}

/// A level while its pixels are made.
struct LevelScan<'a> {
    exemplar: &'a PictureLevel,
    /// The next coarser level of the exemplar, and that of the canvas.
    above: Option<&'a PictureLevel>,
    coarser: Option<&'a PictureLevel>,
    form: &'a Neighbourhood,
    complete: &'a [bool],
    /// By label.
    books: Vec<Option<KnownNeighbourhoods>>,
    made: PictureLevel,
    sources: Vec<Option<u32>>,
    colour_use: Option<ColourUse>,
    vector: NeighbourhoodVector,
    candidate: NeighbourhoodVector,
}

impl LevelScan<'_> {
    /// Gives pixels the sources that are the finer pixels of those of the next coarser level, where these
    /// have the pixel's label.
    fn start(&mut self, coarser_sources: &[Option<u32>]) {
        let (Some(above), Some(coarser)) = (self.above, self.coarser) else { return };
        for i in (0..self.sources.len()).filter(|&i| !self.made.known[i]).collect::<Vec<_>>() {
            let [x, y] = self.made.place(i);
            let Some(source) = coarser_sources[coarser.index([x / 2, y / 2])] else { continue };
            let [u, v] = above.place(source as usize);
            let source = self.exemplar.index([2 * u + x % 2, 2 * v + y % 2]);
            if self.exemplar.known[source] && self.exemplar.label(source) == self.made.label(i) {
                self.take(i, source as u32);
            }
        }
    }

    /// Gives a pixel a source.
    fn take(&mut self, i: usize, source: u32) {
        self.sources[i] = Some(source);
        self.made.pixels[i] = self.exemplar.pixels[source as usize];
        self.made.known[i] = true;
        if let Some(used) = &mut self.colour_use {
            used.add(self.made.label(i), &self.made.pixels[i], 1.0);
        }
    }

    /// Makes a pixel, for the first time or again.
    fn make(&mut self, i: usize, random: &mut Stream) {
        let label = self.made.label(i);
        if let (Some(used), Some(_)) = (&mut self.colour_use, self.sources[i]) {
            used.add(label, &self.made.pixels[i], -1.0);
        }
        self.form.read(&self.made, self.coarser, self.made.place(i), &mut self.vector);
        if let Some(source) = self.found(i, label, random) {
            self.take(i, source);
        }
    }

    /// The exemplar pixel for a pixel whose neighbourhood was read.
    fn found(&mut self, i: usize, label: u32, random: &mut Stream) -> Option<u32> {
        let known = self.books[label as usize].as_ref()?;
        if !self.form.has_colour(&self.vector) {
            return Some(known.middles[random.index(known.middles.len())]);
        }
        let (values, gaps) = (&self.vector.values, self.vector.gaps());
        let (exemplar, used) = (self.exemplar, &self.colour_use);
        let cost = |source: u32, far: f32| {
            far * used.as_ref().map_or(1.0, |used| used.factor(label, &exemplar.pixels[source as usize]))
        };
        let by_vector = |v: u32, far: f32| cost(known.middles[v as usize], far);
        let (nearest, mut least) = known.book.search(&known.vectors, values, gaps, by_vector);
        let mut best = known.middles[nearest as usize];
        let mut seen = [best; AROUND.len() + 1];
        let [x, y] = self.made.place(i);
        for (k, [dx, dy]) in AROUND.into_iter().enumerate() {
            let Some(source) = self.sources[self.made.index([x + dx, y + dy])] else { continue };
            let [u, v] = exemplar.place(source as usize);
            let [u, v] = [u - dx, v - dy];
            if u < 0 || v < 0 || u >= exemplar.size[0] as i64 || v >= exemplar.size[1] as i64 {
                continue;
            }
            let source = exemplar.index([u, v]) as u32;
            let suits = self.complete[source as usize] && exemplar.label(source as usize) == label;
            if !suits || seen.contains(&source) {
                continue;
            }
            seen[k + 1] = source;
            self.form.read(exemplar, self.above, [u, v], &mut self.candidate);
            let cost = cost(source, distance_of_known(values, &self.candidate.values, gaps));
            if cost < least {
                (best, least) = (source, cost);
            }
        }
        Some(best)
    }
}
