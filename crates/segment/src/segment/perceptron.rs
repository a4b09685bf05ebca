//! A small neural network with one hidden layer.

/// A perceptron with `F` features, one hidden layer of `H` rectified units and a logistic output. It
/// scores candidates for textons.
#[derive(Clone, Debug, PartialEq)]
pub struct Perceptron<const F: usize, const H: usize> {
    /// Mean of each feature over the training set.
    pub mean: [f32; F],
    /// Inverse of each feature's standard deviation over the training set.
    pub scale: [f32; F],
    /// Weights of the hidden units.
    pub hidden: [[f32; F]; H],
    /// Offsets of the hidden units.
    pub hidden_offset: [f32; H],
    /// Weights of the output unit.
    pub output: [f32; H],
    /// Offset of the output unit.
    pub output_offset: f32,
}

impl<const F: usize, const H: usize> Perceptron<F, H> {
    /// The output for the given features, a probability from 0 to 1.
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
