// Based on: J. Pernsteiner, Ensuring the Effectiveness of CHC++ in Vulkan, 2020, algorithms 4.1 to 4.3. Where
// we differ from what is printed, as it draws leaves twice, never goes down visible nodes, or asks too much:
// - visible nodes are opened whether or not they are leaves (4.1, line 20 stands outside of the test);
// - whether a node was visible counts for the frame before only, and each visit starts with "no"
//   (VisitStates);
// - leaves assumed to be visible are pulled up like those that were asked about;
// - a re-tested leaf that is visible is not opened again, as it is drawn;
// - re-tests are submitted after the loop that records them (4.2, lines 9-10);
// - pulling up ends at the root, and nothing is submitted where nothing is to be asked.
#include "core/draw/chc_plus_traversal.h"

#include <algorithm>

#include "core/base/splitmix.h"
#include "core/draw/multi_query.h"

namespace sightline {

ChcPlusTraversal::ChcPlusTraversal(const DrawScene& scene, const ChcOptions& options, uint64_t seed,
                                   VisitStates& states, FrameRecorder& frame, const Camera& camera,
                                   uint64_t number)
    : tree_(scene.tree),
      options_(options),
      seed_(seed),
      states_(states),
      frame_(frame),
      number_(number),
      nodes_(scene.tree, camera) {
  if (!tree_.nodes.empty()) nodes_.push(0);
}

void ChcPlusTraversal::run() {
  while (!nodes_.empty() || !asked_.empty()) {
    checkQueries();
    if (!nodes_.empty()) {
      ++ticks_;
      visit(nodes_.pop());
    }
    if (nodes_.empty() && (!options_.late_issue || asked_.empty())) issueMultiQueries();
  }
  endFrame();
}

void ChcPlusTraversal::checkQueries() {
  while (!asked_.empty() && (nodes_.empty() || firstArrived())) {
    fillWait();
    handleFirst();
  }
}

bool ChcPlusTraversal::firstArrived(bool now) {
  return frame_.arrived(asked_.front().query, ticks_ - asked_.front().tick, now);
}

/// Asks about visible leaves until the first answer is there.
void ChcPlusTraversal::fillWait() {
  // Where each question is a submit, none may be asked for want of a look.
  while (!v_queue_.empty() && !firstArrived(!options_.batching)) {
    if (asking_.empty()) beginBatch();
    ++ticks_;
    ask(v_queue_.front(), true);
    v_queue_.pop_front();
    if (!options_.batching) submitAsked();
  }
  submitAsked();
}

void ChcPlusTraversal::handleFirst() {
  const Asked asked = asked_.front();
  asked_.pop_front();
  if (!frame_.visible(asked.query)) {
    for (uint32_t i = 0; i < asked.node_count; ++i)
      ++states_[asked_nodes_[asked.first_node + i]].hidden_frames;
  } else if (asked.node_count == 1) {
    const uint32_t node = asked_nodes_[asked.first_node];
    becomeVisible(node);
    if (asked.retest) {
      states_[node].next_test = number_ + 1 + options_.assumed_frames;
    } else {
      open(node);
    }
  } else {
    ++frame_.counts.failed_queries;
    for (uint32_t i = 0; i < asked.node_count; ++i) {
      const uint32_t node = asked_nodes_[asked.first_node + i];
      if (options_.c_queue) {
        c_queue_.push_back(node);
      } else {
        ask(node, false);
      }
    }
    if (!options_.c_queue) submitAsked(options_.batching);
  }
}

void ChcPlusTraversal::visit(uint32_t index) {
  ++frame_.counts.node_visits;
  const BoxNode& node = tree_.nodes[index];
  if (!states_.mayShow(index, frame_.guard().frustum())) return;
  const bool was_visible = states_.visit(index, number_);
  const auto grown = frame_.guard().grown(node.box);
  if (!grown) {
    if (was_visible) {
      states_.pullUp(index);
    } else {
      becomeVisible(index);
    }
    return open(index);
  }
  states_[index].grown = *grown;
  if (!was_visible) {
    i_queue_.push_back(index);
    if (i_queue_.size() > options_.batch_size) issueMultiQueries();
    return;
  }
  if (node.isLeaf()) {
    if (states_[index].next_test <= number_) {
      v_queue_.push_back(index);
    } else {
      states_.pullUp(index);
    }
  }
  open(index);
}

void ChcPlusTraversal::open(uint32_t index) {
  const BoxNode& node = tree_.nodes[index];
  if (node.isLeaf()) {
    frame_.draw(node.item);
  } else {
    nodes_.pushChildren(index);
  }
}

void ChcPlusTraversal::becomeVisible(uint32_t index) {
  states_.pullUp(index);
  states_[index].hidden_frames = 0;
  states_[index].next_test = number_ + 1 + jitter(index);
}

void ChcPlusTraversal::issueMultiQueries() {
  if (i_queue_.empty() && c_queue_.empty()) return;
  beginBatch();
  std::stable_sort(i_queue_.begin(), i_queue_.end(), [&](uint32_t a, uint32_t b) {
    return states_[a].hidden_frames > states_[b].hidden_frames;
  });
  std::vector<double> hidden;
  hidden.reserve(i_queue_.size());
  for (const uint32_t node : i_queue_) hidden.push_back(stillHidden(states_[node].hidden_frames));
  for (size_t first = 0; first < i_queue_.size();) {
    const uint32_t count = options_.multi_queries ? multiQuerySize(std::span(hidden).subspan(first)) : 1;
    ask(std::span(i_queue_).subspan(first, count), false);
    first += count;
  }
  i_queue_.clear();
  for (const uint32_t node : c_queue_) ask(node, false);
  c_queue_.clear();
  submitAsked();
}

void ChcPlusTraversal::endFrame() {
  if (!v_queue_.empty()) beginBatch();
  for (const uint32_t leaf : v_queue_) ask(leaf, true);
  v_queue_.clear();
  placeAsked(frame_.finish());
  while (!asked_.empty()) handleFirst();  // re-tests only: nothing more is drawn
}

/// Draws have a submit of their own where they are not batched with the queries after them.
void ChcPlusTraversal::beginBatch() {
  if (!options_.batching) frame_.submit();
}

void ChcPlusTraversal::ask(std::span<const uint32_t> nodes, bool retest) {
  boxes_.clear();
  for (const uint32_t index : nodes) {
    const BoxNode& node = tree_.nodes[index];
    const auto tight =
        options_.tight_bounds && !node.isLeaf() ? tree_.tightOf(node) : std::span<const AxisBox>();
    // The node's own box has grown (visit), and so do those in it, but for the last digit.
    const AxisBox& own = states_[index].grown;
    if (tight.empty()) boxes_.push_back(own);
    for (const AxisBox& box : tight) boxes_.push_back(frame_.guard().grown(box).value_or(own));
  }
  frame_.ask(boxes_);
  if (nodes.size() > 1) ++frame_.counts.multi_queries;
  if (retest) ++frame_.counts.retest_queries;
  asking_.push_back({0, uint32_t(asked_nodes_.size()), uint32_t(nodes.size()), retest, 0});
  asked_nodes_.insert(asked_nodes_.end(), nodes.begin(), nodes.end());
}

void ChcPlusTraversal::submitAsked(bool draws) {
  if (!asking_.empty()) placeAsked(frame_.submit(draws));
}

void ChcPlusTraversal::placeAsked(QueryId first) {
  for (Asked& asked : asking_) {
    asked.query = first++;
    asked.tick = ticks_;
    asked_.push_back(asked);
  }
  asking_.clear();
}

/// Uniform in 0 .. assumed_frames.
uint64_t ChcPlusTraversal::jitter(uint32_t node) const {
  const uint64_t bits = splitmix(splitmix(splitmix(seed_) ^ node) ^ number_);
  return ((bits >> 32) * (uint64_t{options_.assumed_frames} + 1)) >> 32;
}

}  // namespace sightline
