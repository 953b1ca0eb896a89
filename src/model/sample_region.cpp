#include "mottle/model/sample_region.hpp"

#include "mottle/stats/distributions/standard_normal.hpp"

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
  constexpr int k_plain = 300, k_wide = 100;
  constexpr double k_stretch = 1.25;
  const auto stretched = [&](const Eigen::Ref<const Eigen::MatrixXd>& uniforms) {
    return distribution.from_standard_normal(k_stretch * uniforms.unaryExpr(&standard_normal_quantile));
  };
  const auto key = [](std::uint64_t seed) { return StreamKey{.seed = seed, .purpose = StreamPurpose::basis_training}; };
  Eigen::MatrixXd samples(k_plain + k_wide, space.count());
  samples << space.draw(distribution, SamplingDesign::latin_hypercube, k_plain, key(1)).samples,
      space.draw(stretched, SamplingDesign::latin_hypercube, k_wide, key(2)).samples;
  return {centre, samples};
}

}  // namespace mottle::model
