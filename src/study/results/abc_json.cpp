#include "study/results/abc_json.hpp"

#include "mottle/formats/tables/csv.hpp"

namespace mottle::study {

void add_abc(const AbcFindings* found, Json& result) {
  result["abc"] = nullptr;
  if (found == nullptr) return;
  Json stages = Json::array();
  for (const AbcStage& stage : found->stages) {
    stages.push_back({{"simulations", stage.simulations},
                      {"accepted", stage.accepted},
                      {"tolerance", number_json(stage.tolerance)},
                      {"effective_samples", number_json(stage.effective_samples)}});
  }
  result["abc"] = {{"distance", found->distance},
                   {"distances", found->distances},
                   {"simulated_distance", number_json(found->simulated_distance)},
                   {"exceeded", number_json(found->exceeded)},
                   {"stages", std::move(stages)},
                   {"fraction", number_json(found->fraction)},
                   {"calibration",
                    {{"sets", found->calibration_sets},
                     {"coordinates", found->coordinates},
                     {"coverage", to_json(found->coverage)},
                     {"factor", to_json(found->factor)},
                     {"checked_coverage", number_json(found->checked_coverage)},
                     {"checked_standard_error", number_json(found->checked_standard_error)}}},
                   {"posterior",
                    {{"file", "posterior.csv"},
                     {"chains", found->chains},
                     {"draws", found->draws},
                     {"names", found->names},
                     {"r_hat", to_json(found->r_hat)}}},
                   {"likelihood",
                    {{"better", found->is_likelihood_better},
                     {"normality_p", number_json(found->normality_p)},
                     {"curvature", number_json(found->curvature)},
                     {"width_ratio_mean", number_json(found->width_ratio_mean)},
                     {"width_ratio_std", number_json(found->width_ratio_std)}}}};
}

std::string abc_csv(const AbcFindings& found) {
  std::vector<std::string> header{"chain", "draw"};
  header.insert(header.end(), found.names.begin(), found.names.end());
  Eigen::MatrixXd rows(found.values.rows(), found.values.cols() + 2);
  for (Eigen::Index k = 0; k < rows.rows(); ++k) {
    const Eigen::Index chain = k / found.draws;
    rows.row(k) << static_cast<double>(chain + 1), static_cast<double>(k % found.draws + 1), found.values.row(k);
  }
  return format_csv(header, rows);
}

}  // namespace mottle::study
