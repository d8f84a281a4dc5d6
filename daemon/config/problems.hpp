#pragma once

#include "bandit/hmm_bandit/arm.hpp"
#include "bandit/hmm_selection/policies.hpp"
#include "bandit/lti/catalogue.hpp"
#include "bandit/restless/policy.hpp"
#include "daemon/config/field_reader.hpp"
#include "dwell/v1/config.pb.h"

namespace dwell {

/// The scheduling problems of a config, one file each in this folder: the message into the domain struct, all that is
/// wrong with it into the reader's violations; where there are none the problem can be solved. Of a policy, `in` reads
/// the message of its parameters.

lti::Problem read_lti(FieldReader in);
lti::Policy read_lti_policy(FieldReader in, v1::LtiPolicy::KindCase kind, int sensors);

hmm_selection::Problem read_hmm_selection(FieldReader in);
hmm_selection::PolicySettings read_hmm_selection_policy(FieldReader in, v1::HmmSelectionPolicy::KindCase kind,
                                                        int sensors);

/// rows x columns from a list in row-major order; zero where it is absent, has another count or a bad value, which is
/// then noted.
Eigen::MatrixXd read_matrix(FieldReader& in, const char* field, const Range& range, Eigen::Index rows,
                            Eigen::Index columns);

/// Rows of the square matrix that a list is, by its count; 0 where it is none.
int side_of(const FieldReader& in, const char* field);

inline Range entry() { return within(-1e9, 1e9); }

restless::Problem read_restless(FieldReader in);
restless::PolicySettings read_restless_policy(FieldReader in, v1::RestlessPolicy::KindCase kind);

hmm_bandit::Problem read_hmm_bandit(FieldReader in);

}  // namespace dwell
