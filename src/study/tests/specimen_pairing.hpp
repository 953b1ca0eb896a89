// Assignment of one specimen's modes to those of the model's reference.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "mottle/dynamics/modes/close_modes.hpp"
#include "mottle/layers.hpp"
#include "mottle/model/structure_model.hpp"
#include "study/tests/measured_modes.hpp"
#include "study/tests/mistaken_sensors.hpp"
#include "study/tests/shape_comparison.hpp"

namespace mottle::study {

/// Sum of MAC over the pairs of an optimal assignment.
double total_mac(const StructureModel& model, const MeasuredModes& modes);

/// A row of the table of pairs.
struct PairingRow {
  int mode = 0;            ///< the model's, counted from 1
  Eigen::Index test = -1;  ///< the specimen's, counted from 0; -1: there is none
  double mac = 0.0, second_mac = 0.0;
  std::string verdict, reason = {};
};

/// Fills a specimen's outputs and its rows of the table.
class SpecimenPairing {
 public:
  /// The arguments must live as long.
  SpecimenPairing(const StructureModel& model, const MeasuredModes& modes, bool by_mac);

  Eigen::Index unknown_components() const { return modes_.shapes.rows() - comparison_.seen; }
  void fill(Eigen::Ref<Eigen::RowVectorXd, 0, Eigen::InnerStride<>> row) const;
  std::vector<PairingRow> rows() const;
  /// The paired shapes, at the measured components that the model has.
  std::vector<ComparedShape> compared_shapes() const;
  /// Modes, counted from 1, whose shapes are outputs but have no modal mass where their size is data.
  std::vector<int> modes_without_size() const;
  /// Measured mode of each reference mode, both counted from 0.
  const std::map<int, Eigen::Index>& assigned() const { return assigned_; }

 private:
  void leave_out_unlike();
  Eigen::MatrixXd known_reference() const;
  std::string doubt(int reference, Eigen::Index test) const;
  double value_of(const Quantity& output, Eigen::Index test, double scale) const;
  double second(int reference, Eigen::Index test) const;
  double fitted_scale(int reference, Eigen::Index test) const;
  bool has_size(Eigen::Index test) const;
  double scale_of(int reference, Eigen::Index test) const;
  double component(const std::string& name, Eigen::Index test) const;

  const StructureModel& model_;
  const MeasuredModes& modes_;
  ShapeComparison comparison_;
  Eigen::MatrixXd mac_;
  std::map<int, Eigen::Index> assigned_;  // measured mode of each reference mode
  std::map<int, CloseModes> mixed_;       // those that are paired together with others alone, by the reference's mode
};

}  // namespace mottle::study
