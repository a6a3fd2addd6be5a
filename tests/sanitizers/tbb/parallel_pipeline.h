// Stand-in for oneTBB, see threads.h. Three filters as this project has them: first and last one at a time and in
// order.
#pragma once

#include <condition_variable>
#include <functional>
#include <optional>
#include <type_traits>

#include "threads.h"

namespace tbb {

enum class filter_mode { serial_in_order, parallel };

class flow_control {
 public:
  void stop() { stopped_ = true; }
  bool is_stopped() const { return stopped_; }

 private:
  bool stopped_ = false;
};

namespace stand_in {

template <class Value>
using Input = std::function<std::optional<Value>()>;

template <class In, class Out>
struct Filter {
  std::function<Out(In)> call;
};
template <class Out>
struct Filter<void, Out> {
  Input<Out> call;
};

template <class Value, class Row>
struct Two {
  Input<Value> input;
  std::function<Row(Value)> work;
};
template <class Value, class Row>
struct Three {
  Input<Value> input;
  std::function<Row(Value)> work;
  std::function<void(Row)> output;
};
template <class Value, class Row>
Two<Value, Row> operator&(Filter<void, Value> a, Filter<Value, Row> b) {
  return {a.call, b.call};
}
template <class Value, class Row>
Three<Value, Row> operator&(Two<Value, Row> a, Filter<Row, void> b) {
  return {a.input, a.work, b.call};
}

}  // namespace stand_in

template <class In, class Out, class Body>
stand_in::Filter<In, Out> make_filter(filter_mode, const Body& body) {
  if constexpr (std::is_void_v<In>) {
    return {[body]() -> std::optional<Out> {
      flow_control flow;
      Out value = body(flow);
      return flow.is_stopped() ? std::nullopt : std::optional<Out>(value);
    }};
  } else {
    return {body};
  }
}

/// @param tokens  items that are on their way at a time
template <class Value, class Row>
void parallel_pipeline(std::size_t tokens, const stand_in::Three<Value, Row>& filters) {
  std::mutex guard;
  std::condition_variable stored;
  std::size_t begun = 0, ended = 0;
  bool done = false, failed = false;
  stand_in::run(std::min(tokens, stand_in::threads()), [&](std::size_t) {
    try {
      for (;;) {
        std::unique_lock lock(guard);
        if (done || failed) return;
        const std::optional<Value> value = filters.input();
        if (!value) {
          done = true;
          return;
        }
        const std::size_t number = begun++;
        lock.unlock();
        Row row = filters.work(*value);
        lock.lock();
        stored.wait(lock, [&] { return failed || ended == number; });
        if (failed) return;
        filters.output(row);
        ++ended;
        stored.notify_all();
      }
    } catch (...) {
      const std::lock_guard lock(guard);
      failed = true;
      stored.notify_all();
      throw;
    }
  });
}

}  // namespace tbb
