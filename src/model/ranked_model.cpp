#include "mottle/model/ranked_model.hpp"

#include <optional>

#include "mottle/core/gather_alike.hpp"
#include "mottle/core/rank_share.hpp"
#include "mottle/model/sample_region.hpp"

namespace mottle::model {

Digest digest_of_samples(const SampleRegion* region, const Eigen::Ref<const Eigen::MatrixXd>& samples) {
  const Eigen::MatrixXd whole = samples;
  Checksum checksum;
  if (region != nullptr) checksum.add(hexadecimal(region->digest()));
  checksum.add(std::to_string(whole.rows()));
  checksum.add(whole.data(), static_cast<std::size_t>(whole.size()) * sizeof(double));
  return checksum.digest();
}

Evaluation RankedModel::evaluate(const SampleRegion* region, const Eigen::Ref<const Eigen::MatrixXd>& samples,
                                 const RunContext& context) const {
  RunContext shared = context;
  std::optional<RankShare> share;
  if (ranks_ != nullptr && ranks_->is_together()) {
    (void)gather_alike(*ranks_, {{digest_of_samples(region, samples), "the samples of a batch"}});
    shared.share = &share.emplace(*ranks_);
  }
  return region == nullptr ? model_.evaluate(samples, shared) : model_.evaluate_in(*region, samples, shared);
}

}  // namespace mottle::model
