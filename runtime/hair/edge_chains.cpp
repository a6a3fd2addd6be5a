// Union-find tells which edges hang together; those with one vertex more than edges and no vertex of three edges are
// chains, and are walked from one end. O(n log n) in the edges, whatever the numbers of the vertices are.
#include "pelage/hair/edge_chains.h"

#include <algorithm>
#include <limits>

namespace pelage::hair {
namespace {

constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();

struct Vertex {
  std::size_t parent, edges = 0;
  Edge edge{kNone, kNone};  // the first two of them
};

/// What a union-find root knows of all that hangs together with it.
struct Piece {
  std::size_t vertices = 0, edges = 0;
  std::size_t end = kNone;  // of a chain: the one that is named first
  bool forks = false, taken = false;
};

class Chains {
 public:
  explicit Chains(const std::vector<Edge>& edges) : edges_(edges) {
    for (const Edge& e : edges) names_.insert(names_.end(), e.begin(), e.end());
    std::sort(names_.begin(), names_.end());
    names_.erase(std::unique(names_.begin(), names_.end()), names_.end());
    for (std::size_t v = 0; v < names_.size(); ++v) vertices_.push_back({v});
    for (Edge& e : edges_)
      for (std::size_t& v : e)
        v = static_cast<std::size_t>(std::lower_bound(names_.begin(), names_.end(), v) - names_.begin());
    for (std::size_t i = 0; i < edges_.size(); ++i) link(i);
    measure();
  }

  void run(const std::function<void(std::span<const std::size_t>)>& take) {
    for (std::size_t i = 0; i < edges_.size(); ++i) {
      Piece& piece = pieces_[root(edges_[i][0])];
      if (!is_chain(piece)) {
        if (chain_.empty() || chain_.back() != names_[edges_[i][0]]) {
          flush(take);
          chain_.push_back(names_[edges_[i][0]]);
        }
        chain_.push_back(names_[edges_[i][1]]);
        continue;
      }
      flush(take);
      if (piece.taken) continue;
      piece.taken = true;
      walk(piece);
      flush(take);
    }
    flush(take);
  }

 private:
  std::size_t root(std::size_t v) {
    while (vertices_[v].parent != v) v = vertices_[v].parent = vertices_[vertices_[v].parent].parent;
    return v;
  }

  void link(std::size_t edge) {
    for (const std::size_t v : edges_[edge]) {
      Vertex& vertex = vertices_[v];
      if (vertex.edges < 2) vertex.edge[vertex.edges] = edge;
      ++vertex.edges;
    }
    vertices_[root(edges_[edge][0])].parent = root(edges_[edge][1]);
  }

  void measure() {
    pieces_.resize(vertices_.size());
    for (std::size_t v = 0; v < vertices_.size(); ++v) {
      Piece& piece = pieces_[root(v)];
      ++piece.vertices;
      piece.forks = piece.forks || vertices_[v].edges > 2;
    }
    for (const Edge& e : edges_) {
      Piece& piece = pieces_[root(e[0])];
      ++piece.edges;
      for (const std::size_t v : e)
        if (piece.end == kNone && vertices_[v].edges == 1) piece.end = v;
    }
  }

  static bool is_chain(const Piece& piece) { return !piece.forks && piece.vertices == piece.edges + 1; }

  void walk(const Piece& piece) {
    std::size_t at = piece.end, came_by = kNone, along = 0;
    chain_.push_back(names_[at]);
    for (std::size_t k = 0; k < piece.edges; ++k) {
      const Edge& here = vertices_[at].edge;
      came_by = here[here[0] == came_by ? 1 : 0];
      const Edge& edge = edges_[came_by];
      along += edge[0] == at ? 1U : 0U;
      at = edge[edge[0] == at ? 1 : 0];
      chain_.push_back(names_[at]);
    }
    if (along == 0) std::reverse(chain_.begin(), chain_.end());
  }

  void flush(const std::function<void(std::span<const std::size_t>)>& take) {
    if (!chain_.empty()) take(chain_);
    chain_.clear();
  }

  std::vector<Edge> edges_;         // by index into names_
  std::vector<std::size_t> names_;  // sorted
  std::vector<Vertex> vertices_;
  std::vector<Piece> pieces_;
  std::vector<std::size_t> chain_;
};

}  // namespace

void for_each_chain(const std::vector<Edge>& edges, const std::function<void(std::span<const std::size_t>)>& take) {
  Chains(edges).run(take);
}

}  // namespace pelage::hair
