#pragma once
#include <algorithm>
#include <atomic>
#include <cstddef>
#include <exception>
#include <functional>
#include <map>
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

/// The part of TBB that Sightline uses, made of std::thread, for builds with ThreadSanitizer: it does not see
/// how Debian's libtbb, which is compiled without it, hands work from thread to thread, and would report each
/// such hand-over as a race. Slow, and always with several threads, however few cores there are.
namespace tbb {
namespace plain_threads {

/// Of one loop.
inline constexpr int kThreads = 4;
/// Of the process: loops that start when there are as many run in their own thread.
inline constexpr int kMostThreads = 32;
inline std::atomic<int> threads{0};

/// Keeps the first exception of several threads.
class FirstException {
 public:
  template <typename Body>
  void run(const Body& body) {
    try {
      body();
    } catch (...) {
      const std::lock_guard lock(mutex_);
      if (!exception_) exception_ = std::current_exception();
    }
  }
  void rethrow() {
    if (exception_) std::rethrow_exception(std::exchange(exception_, nullptr));
  }

 private:
  std::mutex mutex_;
  std::exception_ptr exception_;
};

/// Calls body(i) for i = 0 .. count - 1. Who does what is settled before: a shared counter would put the
/// threads into an order that hides races.
template <typename Body>
void forEach(size_t count, const Body& body) {
  FirstException exception;
  const int wanted = int(std::min<size_t>(kThreads, count));
  const int team = threads + wanted > kMostThreads ? 1 : wanted;
  threads += team;
  const auto work = [&](int member) {
    exception.run([&] {
      for (size_t i = size_t(member); i < count; i += size_t(team)) body(i);
    });
  };
  std::vector<std::thread> others;
  for (int member = 1; member < team; ++member) others.emplace_back(work, member);
  if (team > 0) work(0);
  for (std::thread& other : others) other.join();
  threads -= team;
  exception.rethrow();
}

}  // namespace plain_threads

template <typename T>
class blocked_range {
 public:
  blocked_range(T begin, T end, size_t grain = 1)
      : begin_(begin), end_(end), grain_(std::max<size_t>(grain, 1)) {}
  T begin() const { return begin_; }
  T end() const { return end_; }
  bool empty() const { return !(begin_ < end_); }

  size_t pieces() const { return empty() ? 0 : (size_t(end_ - begin_) + pieceSize() - 1) / pieceSize(); }
  blocked_range piece(size_t i) const {
    const T first = T(begin_ + T(i * pieceSize()));
    return {first, size_t(end_ - first) < pieceSize() ? end_ : T(first + T(pieceSize())), grain_};
  }

 private:
  size_t pieceSize() const { return std::max(grain_, (size_t(end_ - begin_) + 63) / 64); }

  T begin_, end_;
  size_t grain_;
};

template <typename T, typename Body>
void parallel_for(const blocked_range<T>& range, const Body& body) {
  plain_threads::forEach(range.pieces(), [&](size_t i) { body(range.piece(i)); });
}

template <typename T, typename Body>
void parallel_for(T first, T last, const Body& body) {
  parallel_for(blocked_range<T>(first, last), [&](const blocked_range<T>& range) {
    for (T i = range.begin(); i < range.end(); ++i) body(i);
  });
}

template <typename T, typename Value, typename Body, typename Join>
Value parallel_reduce(const blocked_range<T>& range, const Value& identity, const Body& body,
                      const Join& join) {
  std::vector<Value> values(range.pieces(), identity);
  plain_threads::forEach(values.size(), [&](size_t i) { values[i] = body(range.piece(i), identity); });
  Value result = identity;
  for (const Value& value : values) result = join(result, value);
  return result;
}

template <typename A, typename B>
void parallel_invoke(const A& a, const B& b) {
  plain_threads::forEach(2, [&](size_t i) { i == 0 ? a() : b(); });
}

class task_group {
 public:
  ~task_group() { join(); }
  template <typename Body>
  void run(Body body) {
    tasks_.emplace_back([this, body = std::move(body)] { exception_.run(body); });
  }
  void wait() {
    join();
    exception_.rethrow();
  }

 private:
  void join() {
    for (std::thread& task : tasks_) task.join();
    tasks_.clear();
  }

  plain_threads::FirstException exception_;
  std::vector<std::thread> tasks_;
};

class task_arena {
 public:
  static constexpr int automatic = -1;
  explicit task_arena(int = automatic) {}
  template <typename Body>
  auto execute(const Body& body) {
    return body();
  }
};

class global_control {
 public:
  enum parameter { max_allowed_parallelism };
  global_control(parameter, size_t) {}
};

namespace info {
inline int default_concurrency() {
  return plain_threads::kThreads;
}
}  // namespace info

template <typename T>
class enumerable_thread_specific {
 public:
  enumerable_thread_specific() : make_([] { return T(); }) {}
  explicit enumerable_thread_specific(std::function<T()> make) : make_(std::move(make)) {}
  T& local() {
    const std::lock_guard lock(mutex_);
    const auto found = values_.find(std::this_thread::get_id());
    return found != values_.end() ? found->second
                                  : values_.emplace(std::this_thread::get_id(), make_()).first->second;
  }

 private:
  std::function<T()> make_;
  std::mutex mutex_;
  std::map<std::thread::id, T> values_;
};

}  // namespace tbb
