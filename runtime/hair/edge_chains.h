// Private to this box: edges that hang together, as chains of vertices.
#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <span>
#include <vector>

namespace pelage::hair {

using Edge = std::array<std::size_t, 2>;

/// Edges that hang together without a fork or a ring, in whatever order, are one chain. It starts at the end that all
/// its edges lead away from; where their directions contradict each other, at the end that is named first. Of other
/// edges, those that start where the edge before ends continue its chain. Chains come in the order of their first
/// edges.
void for_each_chain(const std::vector<Edge>& edges, const std::function<void(std::span<const std::size_t>)>& take);

}  // namespace pelage::hair
