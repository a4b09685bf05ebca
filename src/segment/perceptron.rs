//! A small network: one hidden layer over a few numbers.

/// One hidden layer of rectified units and a logistic output: how likely, 0 to 1. `F` features,
/// `H` units.
#[derive(Clone, Debug, PartialEq)]
pub struct Perceptron<const F: usize, const H: usize> {
    /// Mean of each feature over the training set.
    pub mean: [f32; F],
    /// One over the deviation of each feature.
    pub scale: [f32; F],
    /// Weights of the hidden units.
    pub hidden: [[f32; F]; H],
    /// Offsets of the hidden units.
    pub hidden_offset: [f32; H],
    /// Weights of the output.
    pub output: [f32; H],
    /// Offset of the output.
    pub output_offset: f32,
}

impl<const F: usize, const H: usize> Perceptron<F, H> {
    /// The answer to these features.
    pub fn score(&self, features: &[f32; F]) -> f32 {
        let x: [f32; F] =
            std::array::from_fn(|k| ((features[k] - self.mean[k]) * self.scale[k]).clamp(-4.0, 4.0));
        let mut sum = self.output_offset;
        for ((weights, offset), out) in self.hidden.iter().zip(self.hidden_offset).zip(self.output) {
            let unit = offset + weights.iter().zip(x).map(|(w, v)| w * v).sum::<f32>();
            sum += out * unit.max(0.0);
        }
        1.0 / (1.0 + libm::expf(-sum))
    }
}
