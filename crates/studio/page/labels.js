// What the page says about each option, in a line or two. The help of the command line is longer.

const LABELS = {
  "size": "Width and height of the texture",
  "dpi": "Pixels per inch; print size follows from it",
  "tile": "Repeat without a seam, along x, y or both",
  "method": "How elements are placed; auto fits it to the picture",
  "variation": "How far the arrangement of a drawing may change",
  "lattice": "Keep rows and lattices of the picture",
  "edge": "Elements at the edge of the shape: keep, clip or avoid them",
  "exclude": "Categories to leave out, with commas between",
  "candidates": "Elements compared per position",
  "moves": "Maximum moves to a better position, for each element",
  "rotate": "Largest random turn of an element",
  "scale-jitter": "Largest random change of size",
  "mirror": "Mirror half of the elements",
  "segmenter": "How elements are found",
  "categories": "Number of groups of similar elements",
  "minimum-area": "Smallest element",
  "shading": "Colours within an element: flat, gradient or soft",
  "fidelity": "Distance that outlines may be off",
  "detail-scale": "Size of the details on elements",
  "detail-minimum": "Smallest detail on an element",
  "secondary-tolerance": "Colour difference of small elements",
  "secondary-minimum": "Smallest of the small elements",
  "secondary-maximum": "Largest of the small elements",
  "background-spacing": "Distance between background colours",
  "background-margin": "Margin around elements left out of the background",
  "colors": "Number of colours; 0 is any",
  "max-paths": "Number of shapes; 0 is any",
  "contrast": "Stretch of contrast before the analysis: auto, off or a factor",
  "even-light": "Take slow changes of light out of the photograph",
  "layers": "Nested layers, such as rust on paint",
  "wrap": "Whether the picture itself tiles",
  "elements": "What counts as an element of a drawing",
  "group": "Which elements of a drawing stay together",
  "lenient": "Leave out what cannot be read of a drawing",
  "background": "Colour behind everything, or none",
  "precision": "Decimals of numbers in the SVG",
  "css": "Write colours as CSS classes",
  "expand": "Write each element in full, for programs without <use>",
};

/** The words below an option, with its range. */
export function labelOf(knob) {
  const text = LABELS[knob.name];
  if (!text) return knob.takes ? `${knob.words} [${knob.takes}]` : knob.words;
  return knob.kind === "number" ? `${text} (${knob.least} to ${knob.most})` : text;
}
