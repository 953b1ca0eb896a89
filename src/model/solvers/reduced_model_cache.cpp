#include "model/solvers/reduced_model_cache.hpp"

#include <ctime>
#include <string>

#include "mottle/core/cache_folder.hpp"
#include "mottle/core/error.hpp"

namespace mottle::model {
namespace {

namespace fs = std::filesystem;

std::unique_ptr<ReducedModel> train(const ReducedModelInputs& inputs, const RunContext& context) {
  auto model =
      std::make_unique<ReducedModel>(inputs.terms, inputs.nominal, inputs.stiffness, inputs.mass, inputs.options);
  model->train(inputs.training, context.threads, [&](Eigen::Index vectors) {
    context.throw_if_stopped();
    context.progress("training the reduced model, vectors", vectors, 0);
  });
  return model;
}

/// Null where there is none that can be used.
std::unique_ptr<ReducedModel> find(const fs::path& path, const ReducedModelFile& file, const ReducedModelInputs& inputs,
                                   const RunContext& context) {
  std::error_code error;
  if (!fs::exists(path, error)) return nullptr;
  try {
    ReducedModelFile::Contents contents = file.read(inputs);
    context.note(fmt::format("reduced model: basis of {} vectors read from {} (trained in {:.2f} s)",
                             contents.model->basis().cols(), path.string(), contents.training_seconds));
    CacheFolder::touch(path);
    return std::move(contents.model);
  } catch (const InvalidInput& reason) {
    context.note(
        fmt::format("reduced model: {} is not used and the basis trained anew: {}", path.string(), reason.what()));
    return nullptr;
  }
}

void keep(const CacheFolder& cache, const fs::path& path, const ReducedModelFile& file, const ReducedModel& model,
          double seconds, const RunContext& context) {
  const std::string what =
      fmt::format("reduced model: basis of {} vectors trained in {:.2f} s", model.basis().cols(), seconds);
  try {
    cache.prepare(2 * sizeof(double) * static_cast<std::uintmax_t>(model.basis().size()));
    file.write(model, seconds);
    context.note(fmt::format("{}, kept in {}", what, path.string()));
    cache.trim(path);
  } catch (const Error& reason) {
    context.note(fmt::format("{}, not kept in {}: {}", what, path.string(), reason.what()));
  }
}

}  // namespace

std::unique_ptr<ReducedModel> find_or_train(const ReducedModelCache& cache, const ReducedModelInputs& inputs,
                                            const RunContext& context) {
  if (cache.folder.empty()) return train(inputs, context);
  const Digest digest = fingerprint(inputs);
  const CacheFolder folder(cache.folder, ".basis", cache.max_bytes);
  const fs::path path = folder.file(digest);
  const ReducedModelFile file(path, digest);
  if (auto found = find(path, file, inputs, context)) return found;
  const std::clock_t begin = std::clock();
  auto model = train(inputs, context);
  keep(folder, path, file, *model, static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC, context);
  return model;
}

}  // namespace mottle::model
