// operator new, and the memory of SQLite, of a test program: counted, and failing from a chosen allocation on or once.
// Link faulty_memory.cpp into the program; all threads count together.
#pragma once

namespace pelage::faults {

/// SQLite's memory too; before its first connection.
void install_memory();
/// The k-th allocation from now on fails, counted from 1, and with `stay_broken` all later ones; 0: none.
void arm_memory(long fail_at, bool stay_broken);
void stop_memory();
/// Allocations since arm_memory().
long allocations();
/// Allocations of both kinds that were not freed.
long live();
/// Did one fail inside nlohmann::json? Its constructors leak what they hold when they throw (3.11).
bool failed_in_json();

}  // namespace pelage::faults
