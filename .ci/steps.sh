# Steps of .ci/run and .ci/full, counted. Sourced, not run.

passed=0 failed=0 skipped=0

# step NAME COMMAND...: runs it and says what came of it; the next step runs in any case.
step() {
    local name=$1 began=$SECONDS
    shift
    echo "--- $name: $*"
    if "$@"; then
        passed=$((passed + 1))
        echo "--- $name: PASSED, $((SECONDS - began)) s"
    else
        failed=$((failed + 1))
        echo "--- $name: FAILED, $((SECONDS - began)) s"
    fi
}

# skip NAME WHY
skip() {
    skipped=$((skipped + 1))
    echo "--- $1: SKIPPED: $2"
}

# The last line, and the exit code.
summary() {
    echo "$passed passed, $failed failed, $skipped skipped"
    [ "$failed" -eq 0 ] && [ "$passed" -gt 0 ]
}
