// Shapes in the columns of a table of tests ("phi8:105:+Z"), as a first study sees them.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "mottle/formats/tables/csv.hpp"
#include "mottle/layers.hpp"
#include "mottle/model/structure_model.hpp"
#include "mottle/study/jobs/init.hpp"

namespace mottle::study {

/// The model's mode that a tested mode is by its shape, in most specimens.
struct ShapeMatch {
  int mode = 0;      ///< by number
  double mac = 0.0;  ///< mean over the specimens that are paired so
};

struct TableShapes {
  std::map<int, ShapeMatch> matches = {};  ///< by the number of the columns; those of no mode are left out
  InitShapes shapes = {};                  ///< modes by the numbers of the columns

  /// Whether columns have the numbers of the model's modes.
  bool counts_as_model() const;
};

/// Shapes at two or more degrees of freedom of the model, paired by MAC; nothing where the table has none.
std::optional<TableShapes> shapes_of_table(const CsvTable& table, const StructureModel& model);

}  // namespace mottle::study
