// Kinematics of a shell's flat element: rigid links from its nodes to an offset and to the corners of a warped element.
#pragma once

#include <Eigen/Core>

#include "fem/elements/shell_flat.hpp"
#include "mottle/layers.hpp"

namespace mottle::fem::shell {

using MotionMatrix = Eigen::Matrix<double, 12, 24>;

/// Of the flat element's corners, from the nodes' degrees of freedom in basic coordinates.
struct Motion {
  bool is_by_node = true;                            ///< each corner moves with its own node alone
  MotionMatrix in_plane = MotionMatrix::Zero();      ///< by corner u, v, rotation about the normal
  MotionMatrix out_of_plane = MotionMatrix::Zero();  ///< by corner w, rotations about x and y
};

Motion motion_of(const Flat& flat, double offset);

/// motion^T local motion, symmetric to the last bit.
ShellMatrix to_basic(const Flat& flat, const Motion& motion, const MotionMatrix& corners,
                     const Eigen::Matrix<double, 12, 12>& local);

/// Both off-diagonal blocks of a section that couples membrane and bending. @param local  in plane by out of plane
ShellMatrix coupling_to_basic(const Motion& motion, const Eigen::Matrix<double, 12, 12>& local);

/// Copies the lower triangle to the upper one.
ShellMatrix symmetric(ShellMatrix matrix);

}  // namespace mottle::fem::shell
