// A SQLite VFS in front of the system's own that counts operations on files and lets chosen ones fail. Registered as
// the default by install(), before the first connection. For one thread.
#pragma once

namespace pelage::faults {

enum class Kind { disk_full, input_output, short_write, killed };

struct Plan {
  long fail_at = 0;  // the operation that fails, counted from 1; 0: none
  Kind kind = Kind::disk_full;
  bool stay_broken = true;  // all later operations fail too, as on a full disk
};

void install();
/// From now on; the count starts anew.
void arm(const Plan& plan);
/// Writes, syncs, truncations and openings since arm().
long operations();

}  // namespace pelage::faults
