#include <memory>

#include "mottle/core/error.hpp"
#include "mottle/core/text.hpp"
#include "mottle/updating/deterministic.hpp"
#include "mottle/updating/mares.hpp"
#include "mottle/updating/updater.hpp"

namespace mottle {
namespace {

template <typename Method, const auto& table>
std::unique_ptr<Updater> make(const OptionValues& values, const std::string& where) {
  return std::make_unique<Method>(table().read(values, where));
}

}  // namespace

const std::vector<MethodEntry>& updating_methods() {
  static const std::vector<MethodEntry> methods = {
      {"mares",
       "Regression on Monte-Carlo clouds, mean and covariance by Eqs. 11 and 12 of Mares, Mottershead and Friswell "
       "(2006).",
       mares_option_table().describe(), make<MaresUpdater, mares_option_table>},
      {"deterministic",
       "One structure, or the mean of many: weighted least squares with Tikhonov or Bayesian regularisation.",
       deterministic_option_table().describe(), make<DeterministicUpdater, deterministic_option_table>},
  };
  return methods;
}

const MethodEntry& find_method(const std::string& name) {
  std::vector<std::string> names;
  for (const MethodEntry& method : updating_methods()) {
    if (method.name == name) return method;
    names.push_back(method.name);
  }
  throw InvalidInput(unknown_name_message("update.method", name, names));
}

std::string status_text(UpdatingStatus status) {
  switch (status) {
    case UpdatingStatus::converged:
      return "converged";
    case UpdatingStatus::max_iterations:
      return "max-iterations";
    case UpdatingStatus::stalled:
      return "stalled";
    case UpdatingStatus::stopped:
      return "stopped";
    case UpdatingStatus::failed:
      return "failed";
  }
  return "failed";
}

}  // namespace mottle
