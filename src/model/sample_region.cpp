#include "mottle/model/sample_region.hpp"

namespace mottle::model {

SampleRegion::SampleRegion(Eigen::VectorXd centre, Eigen::MatrixXd samples)
    : centre_(std::move(centre)), samples_(std::move(samples)) {
  Checksum checksum;
  for (const Eigen::Index size : {samples_.rows(), samples_.cols()}) checksum.add(&size, sizeof(size));
  checksum.add(centre_.data(), static_cast<std::size_t>(centre_.size()) * sizeof(double));
  checksum.add(samples_.data(), static_cast<std::size_t>(samples_.size()) * sizeof(double));
  digest_ = checksum.digest();
}

SampleRegion region_of(const ParameterSpace& space, const Eigen::VectorXd& centre,
                       const JointDistribution& distribution) {
  constexpr int k_samples = 400;
  const StreamKey key{.seed = 1, .purpose = StreamPurpose::basis_training};
  return {centre, space.draw(distribution, SamplingDesign::latin_hypercube, k_samples, key).samples};
}

}  // namespace mottle::model
