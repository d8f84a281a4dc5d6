#pragma once

#include <string>
#include <vector>

#include "bandit/lti/solution.hpp"
#include "radar/random.hpp"

namespace dwell::lti {

/// The examples of the papers, as bandit/lti/README.md reads them.
Problem chung(double communication_noise = 0.0);
Problem gupta(int horizon = 15);
Problem alriksson(double r, int horizon);

struct RandomSize {
  int states = 3;
  int sensors = 3;
  int horizon = 5;
};

/// A system without any structure: A stable or not, W and P[0] of any rank, looks of 1 to n + 1 rows.
Problem random_problem(const RandomSize& size, RandomStream& stream);

/// The same of any size up to 4 states, 3 sensors, 6 steps, and with any of: filtered, final trace, idle, costs,
/// budgets, communication noise.
Problem random_variant(RandomStream& stream);

/// Every feasible schedule, in order.
std::vector<std::vector<int>> all_schedules(const Problem& problem);

/// Cost and final trace written down once more, in the textbook's form with the matrices as they are given.
struct Cost {
  double objective;
  double final_trace;
};
Cost textbook_cost(const Problem& problem, const std::vector<int>& schedule);

/// The least of all schedules, each figure by itself.
Cost enumerated_minimum(const Problem& problem);

/// "1213": schedules of less than ten sensors.
std::vector<int> schedule_of(const std::string& digits);
std::string digits_of(const std::vector<int>& schedule);

}  // namespace dwell::lti
