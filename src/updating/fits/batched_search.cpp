#include "updating/fits/batched_search.hpp"

namespace mottle::updating {

void try_once(const BatchedSearch& searches, std::vector<Eigen::Index>& moving) {
  if (moving.empty()) return;
  Eigen::MatrixXd trials;
  for (std::size_t i = 0; i < moving.size(); ++i) {
    const Eigen::VectorXd trial = searches.propose(moving[i]);
    if (i == 0) trials.resize(static_cast<Eigen::Index>(moving.size()), trial.size());
    trials.row(static_cast<Eigen::Index>(i)) = trial.transpose();
  }
  const Eigen::MatrixXd outputs = searches.evaluate(trials);
  std::vector<Eigen::Index> still;
  for (std::size_t i = 0; i < moving.size(); ++i) {
    const auto row = static_cast<Eigen::Index>(i);
    if (searches.judge(moving[i], trials.row(row).transpose(), outputs.row(row).transpose()))
      still.push_back(moving[i]);
  }
  moving = std::move(still);
}

}  // namespace mottle::updating
