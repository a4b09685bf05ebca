//! vtex turns a photograph of a texture into an editable vector texture of any size.
//!
//! The stages, in the order of the data: [`segment`] finds masks in a photograph, [`analyze`] turns
//! them into a [`library::Library`] of textons (elements), [`synth`] places textons in a
//! [`scene::Scene`], and [`output`] writes the scene as SVG, PDF or PNG. [`edit`] and
//! [`interpolate`] change scenes; [`metrics`] and [`report`] compare results with photographs.
//!
//! Each stage is a function from plain data and one parameter struct to plain data. Libraries and
//! scenes can be saved as JSON and read again. The same input, parameters and seed give the same
//! bytes on any number of threads. The method is that of Palazzolo, van Kaick and Mould, "By-Example
//! Synthesis of Vector Textures" (2025), called "the paper" in this documentation.
//!
//! # Example
//! From a picture to an SVG twice as wide:
//! ```
//! use vtex::analyze::{AnalyzeParams, Exemplar, Limits, analyze};
//! use vtex::output::svg::{self, SvgOptions};
//! use vtex_testing::{SceneKind, SceneParams, generate};
//! use vtex::scene::SynthParams;
//! use vtex::segment::Regions;
//! use vtex::synth::synthesize;
//!
//! // A generated picture stands for a photograph.
//! let params = SceneParams { width: 96, height: 96, kind: SceneKind::Pebbles, size: 20.0, ..Default::default() };
//! let mut png = std::io::Cursor::new(Vec::new());
//! generate(&params)?.image.write_to(&mut png, image::ImageFormat::Png)?;
//!
//! let exemplar = Exemplar::from_bytes(&png.into_inner(), "pebbles.png", &Limits::default())?;
//! let library = analyze(&exemplar, &Regions, &AnalyzeParams::default(), &())?;
//! let scene = synthesize(&library, &SynthParams { width: 192, height: 96, ..Default::default() }, &())?;
//! let mut bytes = Vec::new();
//! svg::write(&scene, &SvgOptions::default(), &mut bytes)?;
//! assert!(bytes.starts_with(b"<?xml") || bytes.starts_with(b"<svg"));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! `()` as the last argument of a stage means that nobody listens to its progress; see [`Progress`].

// The command line names this library as any other program does.
#[cfg(feature = "cli")]
extern crate self as vtex;

#[cfg(feature = "cli")]
mod cli;

#[doc(inline)]
pub use vtex_base::{Error, PROGRAM, Parameter, Progress, Result};

#[cfg(feature = "cli")]
#[doc(hidden)]
pub mod program;

/// The library's error type: what went wrong, where, and what to try.
pub mod error {
    #[doc(inline)]
    pub use vtex_base::error::{EditFault, Error, FillFault, Large, Result};
}

/// Unpacking of gzip, with a bound on what comes out.
pub mod gzip {
    #[doc(inline)]
    pub use vtex_base::gzip::beginning;
}

/// Image → library: primaries, details, secondaries, categories, descriptors, palette.
pub mod analyze {
    #[doc(inline)]
    pub use vtex_analyze::{
        AnalysisMemory, AnalyzeParams, Exemplar, Limits, analyze, analyze_again, borders_join,
    };
}

/// Files that control synthesis and editing: shapes, masks, maps, palettes.
pub mod control {
    #[doc(inline)]
    pub use vtex_drawing::control::{ColourMap, cage, colours, density, level, mask, palette, shape, shares};
}

/// Scene → scene: operations on a finished texture (paper §4.5).
pub mod edit {
    #[doc(inline)]
    pub use vtex_edit::edit::{
        About, Action, ColourOrMap, Comparison, Condition, Direction, Distribution, Files, Identity, Jitter,
        Keep, NumberOrMap, Operation, OrderBy, Outcome, Quantity, ThinOrder, Within, apply, validate,
    };
    /// Text → condition, such as `category=3|5`, `area>200` or `inside=disc.svg`.
    pub mod condition {
        #[doc(inline)]
        pub use vtex_scene::scene::condition::{ConditionFault, EXPECTED, NAMES};
    }
}

/// Elements: what libraries and scenes are made of, a texton of a photograph or a figure of a drawing.
pub mod element {
    #[doc(inline)]
    pub use vtex_scene::element::{
        Appearance, Cap, CategoryId, ElementId, Gaussian, Gradient, GradientKind, Join, Line, Role, Shape,
        SoftRim, Stop,
    };
}

#[cfg(feature = "onnx")]
/// Neural networks: named tensors in, named tensors out. Knows nothing of images.
pub mod engine {
    #[doc(inline)]
    pub use vtex_sam::engine::{
        Engine, EngineChoice, EngineOptions, GIVEN, MINIMUM_MINOR, NetworkSource, Port, Runtime,
        RuntimeCandidate, Tensor, Values, choose, load, locate, version,
    };
}

/// Scene → the same scene carried by a flow, at any time of a loop (Tu, dissertation, sections 4.4.6 and
/// 7.7.3).
pub mod flow {
    #[doc(inline)]
    pub use vtex_edit::flow::{Flow, FlowParams, Flowing, Key};
}

/// Points, rings, outlines with holes, contour tracing, curve fitting.
/// Knows nothing of images, libraries or scenes. Points and paths are those of `kurbo`.
pub mod geometry {
    #[doc(inline)]
    pub use vtex_base::geometry::{
        Affine, BezPath, Cage, Curve, Outline, PathEl, PathText, Point, Rect, STEP, Vec2, is_simple,
        parse_path, write_path,
    };
}

/// Drawing → library: an SVG read as elements in layers.
pub mod import {
    #[doc(inline)]
    pub use vtex_drawing::import::{
        Grouping, ImportParams, as_drawn, drawn, import, is_drawing, shows_lines,
    };
}

/// Two scenes → a scene between them: textons move and change into those of the other scene (paper
/// §4.5, figures 1 and 9).
pub mod interpolate {
    #[doc(inline)]
    pub use vtex_edit::interpolate::{
        Axis, Brush, Interpolation, LayerMotion, Matched, Morph, Motion, MovingShape, across, morph,
    };
}

/// Lattices: translations under which a picture looks the same.
pub mod lattice {
    #[doc(inline)]
    pub use vtex_scene::lattice::Lattice;
}

/// Layers: nested regions of a weathered surface, found in a photograph and made anew.
pub mod layers {
    #[doc(inline)]
    pub use vtex_field::layers::{
        Contacts, Count, Decision, FindParams, FoundLayers, LayerExemplar, LayerMap, LayerPicture,
        LayerRegion, MOST_LAYERS, MapLayer, Terrain, continuous, discrete, find, hole, shape_distance,
    };
}

/// The library of elements: the result of analysing an exemplar (`*.lib.json`).
pub mod library {
    #[doc(inline)]
    pub use vtex_scene::library::{
        AnalyzeParams, Arrangement, Categories, Category, CategoryId, Contrast, ElementId, EvenLight,
        ExemplarElement, ExemplarInstance, ExemplarLayer, Gradient, Grouping, Guide, Lattice, Library, Motif,
        MotifGrouping, MotifPart, Picture, PictureKind, Role, Shading, Shape, Source, SourceKind, Stratum,
        Stretch,
    };
}

/// Measures of the similarity of two pictures of textures; none of them needs a network.
pub mod metrics {
    #[doc(inline)]
    pub use vtex_report::metrics::{Contours, Metrics, SCALE, Spread, compare, reduced, scaled};
    pub use vtex_report::metrics::{ENLARGED, can_compare_contours, contours};
}

/// Scene → files: SVG, SVGZ, PDF, PNG; and SVG → pixels.
pub mod output {
    #[doc(inline)]
    pub use vtex_output::{CSS_DPI, DPI, SceneCategory, categories, coverage, inside};
    /// The table of formats, scenes as files of any of them, and safe writing: a file is replaced as a whole or not at all.
    pub mod file {
        #[doc(inline)]
        pub use vtex_output::file::{gzip, remove_abandoned, remove_unfinished, write_file};
        #[doc(inline)]
        pub use vtex_output::formats::{Ending, FileKind, Format, Uses, WriteOptions, Writer, endings};
        #[doc(inline)]
        pub use vtex_output::writing::{BackgroundChoice, PreparedFile, coloured, packed_ending, users_of};
    }
    /// Layer maps → PNG, SVG and JSON; values → PNG of 16 bits.
    pub mod layer_map {
        #[doc(inline)]
        pub use vtex_output::layer_map::{write_grey, write_json, write_png, write_svg};
    }
    /// Scene → PDF: one page of pure vectors.
    pub mod pdf {
        #[doc(inline)]
        pub use vtex_output::pdf::write;
    }
    /// Scene → pixels and PNG, drawn directly.
    pub mod png {
        #[doc(inline)]
        pub use vtex_output::png::{encode, encode_rgb, over_white, render, render_page, straight};
    }
    /// Frames → one animated file: GIF or animated PNG (APNG).
    pub mod raster_animation {
        #[doc(inline)]
        pub use vtex_output::raster_animation::RasterAnimation;
    }
    /// SVG → pixels, any program's SVG.
    pub mod raster_svg {
        #[doc(inline)]
        pub use vtex_output::raster_svg::{render_part_of, render_svg};
    }
    /// Scene → scene whose SVG stays within a number of bytes.
    pub mod reduce {
        #[doc(inline)]
        pub use vtex_output::reduce::{GivenUp, ReducedScene, to_fit};
    }
    /// The seal of a file: a SHA-256 of its own bytes. It distinguishes a file that is unchanged since it was
    /// written from one that somebody has worked on.
    pub mod seal {
        #[doc(inline)]
        pub use vtex_output::seal::{Sealed, without_seal};
    }
    /// Scene → SVG: pure vectors in groups that designers find easy to navigate.
    pub mod svg {
        #[doc(inline)]
        pub use vtex_output::svg::{
            Animation, SvgOptions, SvgSummary, check_fill, write, write_animation, write_flow, write_pattern,
            write_with_recipe,
        };
    }
}

/// Pixel-based synthesis: textures without elements, as a baseline and for backgrounds.
pub mod pixels {
    #[doc(inline)]
    pub use vtex_field::pixels::{
        ScanParams, by_numbers, carried, extended, filled, scanned, scanned_by_numbers,
    };
}

/// Pixels: decoding, label maps, run-length masks, components, distances, colour spaces.
/// Knows nothing of curves.
pub mod raster {
    #[doc(inline)]
    pub use vtex_base::raster::{
        Connectivity, ControlMap, LabelMap, Limits, Mask, Span, components, components_of_mask, is_picture,
        squared_distance,
    };
    /// Colours: 8-bit sRGB for files; linear light and Oklab for arithmetic.
    pub mod colour {
        #[doc(inline)]
        pub use vtex_base::raster::colour::{Colour, encoded, linear, median, oklab};
    }
    /// Plain names for colours.
    pub mod colour_names {
        #[doc(inline)]
        pub use vtex_base::raster::colour_names::{distinct, name};
    }
    /// Colours as people write them: `#rrggbb`, `#rgb`, or a name of CSS.
    pub mod css {
        #[doc(inline)]
        pub use vtex_base::raster::css::colour;
    }
    /// Diagnostic pictures of label maps.
    pub mod picture {
        #[doc(inline)]
        pub use vtex_base::raster::picture::{label_colour, labels, outlines};
    }
}

/// Library and scene → one HTML page for inspection in a browser.
pub mod report {
    #[doc(inline)]
    pub use vtex_report::report::{Named, Photo, Subject, exemplars, write};
}

/// Random streams, Poisson-disk sets and weighted draws.
pub mod sampling {
    #[doc(inline)]
    pub use vtex_base::sampling::{Area, Stream, poisson_disk, stream};
}

/// The scene: one synthesised texture, that is, layers of placed elements and colour fields
/// (`*.scene.json`).
pub mod scene {
    #[doc(inline)]
    pub use vtex_scene::scene::{
        Ablation, About, Action, Axis, Between, CategoryId, ColourOrMap, Comparison, Condition, ControlPoint,
        Direction, Distribution, Domain, Edge, EditRecord, Element, ElementId, Field, Gradient, Identity,
        Ink, Instance, InstanceId, Jitter, LatticeChoice, Layer, Length, LengthUnit, LibraryId, LibraryRef,
        Method, NumberOrMap, Operation, OrderBy, Place, Quantity, Recorded, Role, Scene, Shadow, Shape,
        Stroke, SynthParams, ThinOrder, Tile, Transfer, TransferMode, Weights, Within, page_at, splat,
    };
    /// The background field: radial basis functions through coloured points.
    pub mod field {
        #[doc(inline)]
        pub use vtex_scene::scene::field::Interpolant;
    }
}

/// Image → masks: candidates for textons. Knows nothing of textons.
pub mod segment {
    #[doc(inline)]
    pub use vtex_segment::segment::{
        Felzenszwalb, GivenCategory, MasksFile, OneTree, Perceptron, Regions, ScoredMask, Segmenter,
        masks_to_bytes,
    };
    /// Promptable segmenters: they return masks of the object at a given point.
    pub mod prompt {
        #[cfg(feature = "onnx")]
        #[doc(inline)]
        pub use vtex_sam::Sam;
        #[doc(inline)]
        pub use vtex_segment::segment::prompt::{
            Cost, Embedded, FoundMask, Generator, GeneratorParams, Logits, PromptMask, Prompter,
        };
        #[cfg(feature = "onnx")]
        /// Segment Anything in ONNX, in all common exports: an image encoder and a prompt
        /// decoder, in two files or one.
        pub mod sam {
            #[doc(inline)]
            pub use vtex_sam::{Sam, SamRole, recognise};
        }
    }
    /// The built-in segmenter: a tree of merged regions, whose texton-like nodes are selected.
    pub mod regions {
        #[doc(inline)]
        pub use vtex_segment::segment::regions::{
            FEATURES, HIDDEN, Network, NodeCandidate, OneTree, Regions, candidates,
        };
    }
    #[cfg(feature = "onnx")]
    /// The texton segmenter: candidates from a promptable network and from the region tree, scored
    /// together.
    pub mod texton {
        #[doc(inline)]
        pub use vtex_segment::segment::texton::{
            FEATURES, HIDDEN, Judge, MaskCandidate, Texton, TextonNetwork,
        };
    }
}

/// Measures of the arrangement of primaries: overlap, repetition, and pair correlation of the centres of
/// categories.
pub mod statistics {
    #[doc(inline)]
    pub use vtex_scene::statistics::{
        Centre, CopyDistances, CorrelationCurve, Cycle, Difference, Groups, Layout, Overlap,
        PairCorrelations, Repetition, largest_categories, neighbour_distance,
    };
}

/// Library → scene: the method is chosen, it arranges elements, and a scene is composed of them.
pub mod synth {
    #[doc(inline)]
    pub use vtex_arrange::synth::{
        CanvasSize, CategoryReport, ClusterReport, Controls, Cost, CurveReport, DrawnContext, StratumReport,
        Structure, StructureGuide, SynthReport, SynthesisMemory, Turned, layer_map, reconstruct, synthesize,
        synthesize_again, synthesize_with,
    };
}

/// Scene × scenes → scene: the arrangement of one texture with the appearance of others (Tu, dissertation,
/// section 4.4.2 and appendix 7.4).
pub mod transfer {
    #[doc(inline)]
    pub use vtex_edit::transfer::{Keep, StylizeParams, TransferParams, TransferReport, stylize, transfer};
}

/// The weights of the score searched for one library.
pub mod tune {
    #[doc(inline)]
    pub use vtex_arrange::tune::{Terms, TuneParams, TunedWeights, tune};
}

/// Warps scenes to another shape and keeps their density (paper §4.5).
pub mod warp {
    #[doc(inline)]
    pub use vtex_arrange::warp::{Bend, WarpParams, warp};
}
