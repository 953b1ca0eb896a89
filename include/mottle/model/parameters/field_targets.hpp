// Targets of parameters in a finite-element model: names of card fields, "MAT1:2:E", and the numbers that they mean.
#pragma once

#include <string>
#include <vector>

#include "mottle/fem/assembly/assembly.hpp"
#include "mottle/fem/finite_element_model.hpp"
#include "mottle/layers.hpp"
#include "mottle/model/parameters/parameter_targets.hpp"

namespace mottle::model {

/// A number of the model's geometry that a parameter moves: the model is assembled anew for each of its values.
struct GeometryTarget {
  FieldIndex field = k_no_field;  ///< where its value stands
  std::string card;               ///< GRID, or of an element whose traits have geometry numbers
  int index = 0;                  ///< of the node or element
  int number = 0;                 ///< which of its numbers, as in `name`
};

/// Parameters of a model by card fields.
struct FieldTargets {
  std::vector<FieldParameter> parameters;
  std::vector<GeometryTarget> geometry;
  std::vector<PhysicalLimit> limits;  ///< by parameter
};

/// Finds what each parameter acts on. Targets:
///
///   CARD:ID:FIELD   a number that stands in the deck (MAT1:2:E, PELAS:160:K, PSHELL:7:T, CONM2:8:M)
///   GRID:ID:X|Y|Z   basic coordinates
///   CBAR:ID:X1|X2|X3 (CBEAM)      orientation vector, basic;  W1A ... W3B: offsets, basic
///   CONM2:ID:X1|X2|X3             offset of the mass
///   CQUAD4:ID:ZOFFS (CTRIA3)      offset of the shell
///
/// The latter numbers are added to the model's fields.
///
/// Throws InvalidInput ("parameter 'E1': ..."): a target that is not CARD:ID:FIELD, a card, id or field that the deck
/// does not have (with those it has), a field tied to two parameters, a factor on a number that is zero.
FieldTargets find_field_targets(FiniteElementModel& model, const std::vector<ParameterTargets>& parameters);

/// The model with its fields, geometry included, set to what the parameters say.
FiniteElementModel model_at(const FiniteElementModel& model, const FieldTargets& targets,
                            const Eigen::Ref<const Eigen::VectorXd>& parameters);

}  // namespace mottle::model
