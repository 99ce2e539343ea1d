/* The Nth call that changes a file fails, for every N until an act of the appliance makes no more
 * calls. It fails in each of the six ways of tests/support/disk/failing_disk.h in which a disk can
 * fail. Each failure is tried in two ways, with processes of their own:
 *
 *   restart   The process ends after the act. Another process opens the files that it has left.
 *   go on     The disk works again. The process continues for a while, enrols one more person and
 *             ends. Another process opens the files that it has left.
 *
 * The state of the files has to agree with the answer to the client, and with the state that the
 * process had in its memory. Gallery, log and anchors have to open. Nobody may be lost, and no
 * deleted person may be back.
 *
 * The two other kinds of failing_disk.h kill the process before or after the Nth call. Another
 * process opens the files that it has left.
 *
 * usage: storage_faults [STRIDE [ACT]]     exit status 0 if every trial was correct
 *
 * With a stride of 3, each call fails in two of the six ways, and two of three calls are tried with
 * a kill. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/firmware/faults/fault_tally.h"
#include "tests/firmware/faults/storage_trial.h"
#include "tests/support/disk/failing_disk.h"

enum { CALLS_MAX = 5000 };

static long points; /* number of trials */

/* Kills the process at one call. Returns false if the act does not make so many calls. */
static bool kill_at(struct storage_point *point, const struct storage_ends *ends)
{
    point->goes_on = false;
    (void)!storage_try(point);
    if (storage_trial->report.done) {
        return false;
    }
    storage_judge_kill(point, ends);
    points++;
    return true;
}

/* Lets one call fail in one way. Returns false if the act does not make so many calls. */
static bool fail_at(struct storage_point *point, const struct storage_ends *ends)
{
    if (point->kind >= FAILING_DISK_KILLS) {
        return kill_at(point, ends);
    }
    for (int i = 0; i < 2; i++) {
        point->goes_on = i == 1;
        const bool ended = storage_try(point);
        if (ended && storage_trial->report.calls < point->nth) {
            return false;
        }
        if (ended) {
            storage_judge(point, ends);
        } else {
            storage_violation(point, storage_trial->report.done ? "the files do not open"
                                                                : "does not end");
        }
        points++;
    }
    return true;
}

static int do_nothing(struct storage_world *w, struct iso_fault *fault)
{
    (void)w, (void)fault;
    return 0;
}

/* Runs the act on a disk that works. Sets *ends to the states before and after it. Returns how many
 * calls the act makes. */
static long learn(const struct storage_act *of, struct storage_ends *ends)
{
    struct storage_act nothing = *of;
    const struct storage_point before = {&nothing, FAILING_DISK_ONCE, CALLS_MAX, false};
    const struct storage_point after = {of, FAILING_DISK_ONCE, CALLS_MAX, false};
    nothing.act = do_nothing;
    if (!storage_try(&before)) {
        storage_violation(&before, "fails although the disk works");
    }
    ends->before = storage_trial->found;
    if (!storage_try(&after) || storage_trial->report.told) {
        storage_violation(&after, "fails although the disk works");
    }
    if (storage_trial->report.kernel_writes >= 0 &&
        storage_trial->report.kernel_writes != storage_trial->report.writes) {
        storage_violation(&after, "%ld writes, of which the test sees %ld",
                          storage_trial->report.kernel_writes, storage_trial->report.writes);
    }
    ends->after = storage_trial->found;
    return storage_trial->report.calls;
}

int main(int argc, char **argv)
{
    const long stride = argc > 1 ? atol(argv[1]) : 1;
    const char *only = argc > 2 ? argv[2] : "";
    size_t acts = 0;
    if (stride < 1 || !storage_trial_prepare()) {
        fputs("usage: storage_faults [STRIDE [ACT]]\n", stderr);
        return 2;
    }
    for (size_t i = 0; i < storage_acts_n; i++) {
        struct storage_ends ends;
        if (!strstr(storage_acts[i].name, only)) {
            continue;
        }
        const long calls = learn(&storage_acts[i], &ends), before = storage_violations();
        struct storage_point point = {.act = &storage_acts[i]};
        for (int kind = 0; kind < FAILING_DISK_KINDS; kind++) {
            point.kind = (enum failing_disk_kind)kind;
            point.nth = 1 + kind % stride;
            while (fail_at(&point, &ends)) {
                point.nth += stride;
            }
        }
        printf("%-14s %4ld calls, violations %ld\n", storage_acts[i].name, calls,
               storage_violations() - before);
        acts++;
    }
    fault_tally_print("storage faults", points, (long)acts, storage_violations());
    return storage_violations() > 0 || points == 0;
}
