#include "core/pvs/order.h"

namespace sightline {

std::string orderName(Order order) {
  return order == Order::kQueue ? "queue" : "yield";
}

std::optional<Order> orderOf(const std::string& name) {
  if (name == orderName(Order::kQueue)) return Order::kQueue;
  if (name == orderName(Order::kYield)) return Order::kYield;
  return std::nullopt;
}

}  // namespace sightline
