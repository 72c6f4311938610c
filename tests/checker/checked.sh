# Sourced: runs a program whose OpenCL device is Oclgrind's simulator.
# Without optimisation the kernels run as they are written: a compiler may drop a fault, or read what is not used.
# Not --uninitialized: Oclgrind does not take what clEnqueueFillBuffer wrote for initialised.
# One thread: with more, --inst-counts at times breaks off ("corrupted size vs. prev_size").
readonly checks=(--num-threads 1 --data-races --max-errors 1000 --build-options "-cl-opt-disable -DSL_ATOMIC_LOADS")

# checked LOG OPTIONS... PROGRAM ARGS...: findings go to LOG.
checked() {
  local log=$1
  shift
  SIGHTLINE_TEST_TRY_ROUNDING=1 oclgrind --log "$log" "${checks[@]}" "$@"
}
