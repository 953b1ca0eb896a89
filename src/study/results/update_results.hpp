// The result.json of an update, read back.
#pragma once

#include <filesystem>

#include "mottle/layers.hpp"
#include "study/results/result_json.hpp"

namespace mottle::study {

/// result.json of an update's folder.
///
/// @throws InvalidInput  there is none, or it is not of an update
Json read_update_result(const std::filesystem::path& folder);

/// Numbers of a list; null, and what is no number, is nan.
Eigen::VectorXd numbers_of(const Json& list);

}  // namespace mottle::study
