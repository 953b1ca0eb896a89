// The source of a model that a program gives, which no file describes.
#pragma once

#include <memory>

#include "mottle/layers.hpp"
#include "mottle/study/models/model_source.hpp"

namespace mottle::study {

/// model.kind among its results.
inline constexpr const char* k_given_kind = "function";

/// It has neither files nor numbers that could be changed, and makes nothing.
std::shared_ptr<const ModelSource> given_source();

}  // namespace mottle::study
