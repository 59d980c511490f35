"""From pictures to a camera: detection, bundle adjustment, covariance, diagnosis."""
