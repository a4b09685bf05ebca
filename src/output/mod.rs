//! Scene → files: SVG, SVGZ, PNG.
