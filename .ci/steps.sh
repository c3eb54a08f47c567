# Steps of .ci/run and .ci/full, counted. Sourced, not run.

passed=0 failed=0 skipped=0

# step NAME COMMAND...: runs it and says what came of it; the next step runs in any case. Exit code 77: it lacks what it needs, and says what.
step() {
    local name=$1 began=$SECONDS
    shift
    echo "--- $name: $*"
    local code=0
    "$@" || code=$?
    case $code in
        0) passed=$((passed + 1)) && echo "--- $name: PASSED, $((SECONDS - began)) s" ;;
        77) skip "$name" "see above" ;;
        *) failed=$((failed + 1)) && echo "--- $name: FAILED, $((SECONDS - began)) s" ;;
    esac
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
