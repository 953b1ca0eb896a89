#include "mottle/model/parameters/parameter_space.hpp"

#include <algorithm>
#include <cmath>

#include "mottle/core/subject.hpp"

namespace mottle::model {
namespace {

constexpr double k_on_bound = 1e-9;

bool is_within(double value, const PhysicalLimit& limit) {
  return limit.excludes_lower ? value > limit.lower : value >= limit.lower;
}

/// Streams of the rejected samples of one draw, so that each is redrawn from its own stream.
struct Redraw {
  Eigen::Index sample;
  RandomStream stream;
};

}  // namespace

ParameterSpace::ParameterSpace(std::vector<Parameter> parameters, JointDistribution prior)
    : parameters_(std::move(parameters)), prior_(std::move(prior)) {
  require(!parameters_.empty(), "parameter: there is none; give at least one");
  require(prior_.dimension() == count(), "{} parameters but a distribution of {}", count(), prior_.dimension());
  const Eigen::VectorXd mean = prior_.mean();
  for (Eigen::Index i = 0; i < count(); ++i) {
    const Parameter& parameter = parameters_[static_cast<std::size_t>(i)];
    const Subject subject = subject_parameter(parameter.name);
    require_of(parameter.lower_bound < parameter.upper_bound, subject, "bounds [{}, {}] are crossed or empty",
               parameter.lower_bound, parameter.upper_bound);
    require_of(mean(i) >= parameter.lower_bound && mean(i) <= parameter.upper_bound, subject,
               "the mean {} is outside the bounds [{}, {}]", mean(i), parameter.lower_bound, parameter.upper_bound);
    require_of(is_within(mean(i), parameter.limit), subject, "the mean {} is physically impossible, it must be {} {}",
               mean(i), parameter.limit.excludes_lower ? ">" : ">=", parameter.limit.lower);
  }
}

std::vector<std::string> ParameterSpace::names() const {
  std::vector<std::string> names;
  for (const Parameter& parameter : parameters_) names.push_back(parameter.name);
  return names;
}

std::vector<ParameterTransform> ParameterSpace::transforms() const {
  std::vector<ParameterTransform> transforms;
  for (const Parameter& parameter : parameters_) transforms.push_back(parameter.transform);
  return transforms;
}

bool ParameterSpace::is_possible(const Eigen::Ref<const Eigen::RowVectorXd>& sample) const {
  for (Eigen::Index i = 0; i < count(); ++i) {
    if (!is_within(sample(i), parameters_[static_cast<std::size_t>(i)].limit)) return false;
  }
  return true;
}

Eigen::VectorXd ParameterSpace::clamp(const Eigen::Ref<const Eigen::VectorXd>& parameters) const {
  Eigen::VectorXd clamped = parameters;
  for (Eigen::Index i = 0; i < count(); ++i) {
    const Parameter& parameter = parameters_[static_cast<std::size_t>(i)];
    // A limit that is itself impossible (zero stiffness) is approached to a thousandth of the prior mean.
    const double smallest = parameter.limit.excludes_lower
                                ? parameter.limit.lower + 1e-3 * std::abs(prior_.mean()(i) - parameter.limit.lower)
                                : parameter.limit.lower;
    clamped(i) = std::clamp(clamped(i), std::max(parameter.lower_bound, smallest), parameter.upper_bound);
  }
  return clamped;
}

Eigen::VectorXi ParameterSpace::active_bounds(const Eigen::Ref<const Eigen::VectorXd>& parameters) const {
  const Eigen::VectorXd mean = prior_.mean();  // the size of a parameter whose bound is zero
  Eigen::VectorXi active = Eigen::VectorXi::Zero(count());
  for (Eigen::Index i = 0; i < count(); ++i) {
    const Parameter& parameter = parameters_[static_cast<std::size_t>(i)];
    const double tolerance = k_on_bound * std::max(std::abs(mean(i)), std::abs(parameters(i)));
    if (parameters(i) <= parameter.lower_bound + tolerance) active(i) = -1;
    if (parameters(i) >= parameter.upper_bound - tolerance) active(i) = 1;
  }
  return active;
}

ParameterDraw ParameterSpace::draw(const JointDistribution& distribution, SamplingDesign design, Eigen::Index samples,
                                   const StreamKey& key) const {
  return draw([&](const Eigen::Ref<const Eigen::MatrixXd>& uniforms) { return distribution.from_uniform(uniforms); },
              design, samples, key);
}

ParameterDraw ParameterSpace::draw(const SampleTransform& from_uniform, SamplingDesign design, Eigen::Index samples,
                                   const StreamKey& key) const {
  constexpr int k_max_attempts = 10000;
  ParameterDraw draw;
  draw.samples = from_uniform(uniform_design(design, samples, count(), key));
  StreamKey redraw_key = key;
  // Each purpose has its own redraws, else a truth and a cloud of one seed would share them.
  redraw_key.purpose = static_cast<StreamPurpose>((static_cast<std::uint32_t>(StreamPurpose::redraw) << 16U) +
                                                  static_cast<std::uint32_t>(key.purpose));
  std::vector<Redraw> impossible;
  for (Eigen::Index s = 0; s < samples; ++s) {
    if (!is_possible(draw.samples.row(s)))
      impossible.push_back({s, RandomStream(redraw_key, static_cast<std::uint32_t>(s))});
  }
  for (int attempt = 0; !impossible.empty(); ++attempt) {
    require(attempt < k_max_attempts,
            "the distribution of the parameters is almost wholly physically impossible: {} draws in a row gave a "
            "stiffness or mass <= 0; move its mean or narrow it",
            k_max_attempts);
    draw.rejected += static_cast<std::int64_t>(impossible.size());
    Eigen::MatrixXd uniforms(static_cast<Eigen::Index>(impossible.size()), count());
    for (std::size_t i = 0; i < impossible.size(); ++i) {
      for (Eigen::Index j = 0; j < count(); ++j)
        uniforms(static_cast<Eigen::Index>(i), j) = impossible[i].stream.uniform();
    }
    const Eigen::MatrixXd candidates = from_uniform(uniforms);
    std::vector<Redraw> still_impossible;
    for (std::size_t i = 0; i < impossible.size(); ++i) {
      const auto candidate = candidates.row(static_cast<Eigen::Index>(i));
      draw.samples.row(impossible[i].sample) = candidate;
      if (!is_possible(candidate)) still_impossible.push_back(impossible[i]);
    }
    impossible = std::move(still_impossible);
  }
  return draw;
}

}  // namespace mottle::model
