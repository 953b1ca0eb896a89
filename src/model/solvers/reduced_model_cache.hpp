// Trained reduced models in a folder, for the next command on the same model.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>

#include "mottle/core/run_context.hpp"
#include "mottle/layers.hpp"
#include "mottle/linalg/reduced/reduced_model_file.hpp"

namespace mottle::model {

/// Where trained models are kept.
struct ReducedModelCache {
  std::filesystem::path folder;                        ///< empty: nothing is kept
  std::uintmax_t max_bytes = std::uintmax_t{2} << 30;  ///< of all models there; the least recently used go first
};

/// The trained model of these inputs: from the cache where it lies there, else trained and kept there. The same bits
/// either way. A folder that cannot be read or written only prevents the reuse; notes to the context say so.
///
/// @throws InvalidInput  as ReducedModel's constructor
std::unique_ptr<ReducedModel> find_or_train(const ReducedModelCache& cache, const ReducedModelInputs& inputs,
                                            const RunContext& context);

}  // namespace mottle::model
