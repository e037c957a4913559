// SPDX-License-Identifier: Apache-2.0
#include "mjcf/plant/any_tree.h"

namespace tauext {

template class TreeModel<kMostCoordinates, double, kMostCoordinates + kMostFollowers>;

}  // namespace tauext
