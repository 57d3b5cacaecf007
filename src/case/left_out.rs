//! What a case does not need.

use super::Case;
use super::sensitivity::SENSITIVITY;

impl Case {
    /// Parts of the program that this scene does not need, in words.
    pub fn left_out(&self) -> Vec<String> {
        let mut left_out = vec![match self.fixed_network {
            Some(_) if self.copies.is_some() => {
                "a lattice: the voids of the packing are the network".to_string()
            }
            Some(_) => "packing, triangulation and constriction curve: the network is given".to_string(),
            None if self.packed.is_some() => {
                "a given constriction curve: it is measured on the packing".to_string()
            }
            None if self.library.is_some() => {
                "packing and triangulation: the constriction curve is from the library of packings"
                    .to_string()
            }
            None if self.guessed_density.is_some() => {
                "packing and triangulation: the constriction curve is guessed from the gradation".to_string()
            }
            None => "packing and triangulation: the constriction curve is given".to_string(),
        }];
        if let Some(other) = self.packed.as_ref().and_then(|packed| packed.same_shape.as_ref()) {
            left_out.push(format!(
                "packing the filter: the packing in {} has its shape, and was taken {:.4} times as large",
                other.folder, other.factor
            ));
        }
        if self.scene.walk.runs == 1 {
            left_out.push("the second run: it was not asked for".into());
        }
        if self.scene.record.sensitivity.is_empty() {
            left_out.push(format!("{SENSITIVITY}: it was not asked for"));
        }
        left_out.extend(self.sensitivity_not_walked());
        for factor in self.thickness_factors() {
            if let Err(error) = self.of_thickness(factor) {
                left_out.push(format!("a filter {factor} times as thick: {error}"));
            }
        }
        let not_walked = self.thickness_not_walked();
        let is_said = !not_walked.is_empty();
        left_out.extend(not_walked);
        if !is_said
            && self.thickness_factors().is_empty()
            && self.copies.is_none()
            && self.fixed_network.is_none()
        {
            left_out.push("how the verdict moves with the filter's thickness: it was not asked for".into());
        }
        left_out
    }
}
