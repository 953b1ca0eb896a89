#include "study/tests/mistaken_sensors.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>

namespace mottle::study {
namespace {

constexpr double k_matters = 0.02;  // mean of 1 - MAC, from which a change is looked for
constexpr double k_fewer = 0.25;    // of it, that a change may leave
constexpr std::size_t k_most = 40;  // sensors that are tried

/// Products over the measured sensors, where what is not measured counts as zero.
struct Products {
  Eigen::VectorXd measured, reference;
  double measured_square = 0.0, reference_square = 0.0, product = 0.0;

  explicit Products(const ComparedShape& shape) {
    const auto is_known = !(shape.measured + shape.reference).array().isNaN();
    measured = is_known.select(shape.measured, 0.0);
    reference = is_known.select(shape.reference, 0.0);
    measured_square = measured.squaredNorm();
    reference_square = reference.squaredNorm();
    product = measured.dot(reference);
  }

  /// 1 - MAC, where the product is another by `change`.
  double deviation(double change) const {
    return 1.0 - std::pow(product + change, 2) / (measured_square * reference_square);
  }
  double change_turned(Eigen::Index i) const { return -2.0 * measured(i) * reference(i); }
  double change_exchanged(Eigen::Index i, Eigen::Index j) const {
    return (measured(i) - measured(j)) * (reference(j) - reference(i));
  }
  /// Squared difference of each sensor, relative to the reference's square.
  Eigen::ArrayXd differences() const {
    return (product / measured_square * measured - reference).array().square() / reference_square;
  }
};

/// A change of the sensors; second < 0: the first is turned round.
struct SensorChange {
  Eigen::Index first = -1, second = -1;
  double deviation = 0.0;  ///< mean of 1 - MAC over the shapes
};

std::vector<Eigen::Index> worst_sensors(const std::vector<Products>& shapes) {
  Eigen::ArrayXd differences = Eigen::ArrayXd::Zero(shapes.front().measured.size());
  for (const Products& shape : shapes) differences += shape.differences();
  std::vector<Eigen::Index> order(static_cast<std::size_t>(differences.size()));
  std::iota(order.begin(), order.end(), 0);
  std::ranges::stable_sort(order, [&](auto a, auto b) { return differences(a) > differences(b); });
  order.resize(std::min(order.size(), k_most));
  return order;
}

SensorChange best_change(const std::vector<Products>& shapes) {
  const std::vector<Eigen::Index> sensors = worst_sensors(shapes);
  SensorChange best{.deviation = 1.0};
  const auto attempt = [&](Eigen::Index i, Eigen::Index j) {
    double sum = 0.0;
    for (const Products& shape : shapes)
      sum += shape.deviation(j < 0 ? shape.change_turned(i) : shape.change_exchanged(i, j));
    const double deviation = sum / static_cast<double>(shapes.size());
    if (deviation < best.deviation) best = {i, j, deviation};
  };
  for (std::size_t a = 0; a < sensors.size(); ++a) {
    attempt(sensors[a], -1);
    for (std::size_t b = 0; b < a; ++b) attempt(std::min(sensors[a], sensors[b]), std::max(sensors[a], sensors[b]));
  }
  return best;
}

}  // namespace

std::string mistaken_sensors(const std::vector<ComparedShape>& shapes, const std::vector<std::string>& sensors) {
  std::set<int> modes;
  std::vector<Products> products;
  double as_given = 0.0;
  for (const ComparedShape& shape : shapes) {
    Products own(shape);
    if (!(own.measured_square * own.reference_square > 0.0)) continue;
    as_given += own.deviation(0.0);
    modes.insert(shape.mode);
    products.push_back(std::move(own));
  }
  if (sensors.size() < 3 || modes.size() < 2) return {};
  as_given /= static_cast<double>(products.size());
  if (as_given < k_matters) return {};
  const SensorChange best = best_change(products);
  if (best.deviation > k_fewer * as_given) return {};
  const std::string& first = sensors[static_cast<std::size_t>(best.first)];
  if (best.second < 0) {
    return fmt::format(
        "The shapes of {} modes agree far better with the model if the sign of sensor {} is reversed (mean MAC {:.2f} "
        "instead of {:.2f}); they are used as they are. Look whether that sensor is upside down.",
        modes.size(), first, 1.0 - best.deviation, 1.0 - as_given);
  }
  return fmt::format(
      "The shapes of {} modes agree far better with the model if sensors {} and {} are exchanged (mean MAC {:.2f} "
      "instead of {:.2f}); they are used as they are. Look whether the two channels were swapped.",
      modes.size(), first, sensors[static_cast<std::size_t>(best.second)], 1.0 - best.deviation, 1.0 - as_given);
}

std::string mistaken_sensors(const Eigen::Ref<const Eigen::MatrixXd>& values, const OutputSelection& selection,
                             const Eigen::Ref<const Eigen::MatrixXd>& reference) {
  const auto first = static_cast<Eigen::Index>(selection.frequencies.size());
  std::vector<ComparedShape> shapes;
  for (Eigen::Index s = 0; s < values.rows(); ++s) {
    for (Eigen::Index m = 0; m < reference.cols(); ++m) {
      shapes.push_back({selection.shape_modes[static_cast<std::size_t>(m)],
                        values.row(s).segment(first + m * reference.rows(), reference.rows()).transpose(),
                        reference.col(m)});
    }
  }
  return mistaken_sensors(shapes, selection.shape_degrees_of_freedom);
}

}  // namespace mottle::study
