// Coordinate systems that may be given in each other, in any order.
#pragma once

#include "formats/nastran/builder.hpp"
#include "mottle/layers.hpp"

namespace mottle::formats::nastran {

/// Fills model.coordinate_systems from builder.raw_systems; needs raw_points sorted by id.
void resolve_systems(ModelBuilder& builder);

/// Basic coordinates of a point given in a system (index; -1: basic).
Eigen::Vector3d basic_position(const ModelBuilder& builder, int system, const Eigen::Vector3d& coordinates);

}  // namespace mottle::formats::nastran
