#include "tests/enroll/hub/outlet/outlet_rig.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "enroll/hub/outlet/run/hub_outlets.h"

/* ---- the process ---- */

static void block_term(sigset_t *set)
{
    (void)sigemptyset(set);
    (void)sigaddset(set, SIGTERM);
    (void)sigprocmask(SIG_BLOCK, set, NULL);
}

void outlet_rig_main(int argc, char **argv)
{
    struct iso_fault fault = {.text = ""};
    struct hub_store store;
    struct hub_outlets *outlets = NULL;
    sd_event *event = NULL;
    sigset_t set;
    if (argc != 4 || strcmp(argv[1], "outlets") != 0) {
        return;
    }
    const struct hub_store_options options = {
        .conninfo = argv[2], .key_file = argv[3], .hub_name = "head office", .actor = "hub"};
    block_term(&set);
    int error = sd_event_default(&event);
    error = error < 0 ? error : sd_event_add_signal(event, NULL, SIGTERM, NULL, NULL);
    error = error < 0 ? error : hub_store_open(&options, &store, &fault);
    error = error < 0 ? error : hub_outlets_new(event, &store, &options, &outlets, &fault);
    if (error < 0) {
        fprintf(stderr, "%d: %s\n", error, fault.text);
        _exit(1);
    }
    (void)sd_event_loop(event);
    hub_outlets_free(outlets);
    hub_store_close(&store);
    sd_event_unref(event);
    exit(0);
}

pid_t outlet_rig_run(const struct store_rig *rig, const char *log)
{
    const pid_t pid = fork();
    assert_true(pid >= 0);
    if (pid == 0) {
        const int fd = open(log, O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0600);
        (void)prctl(PR_SET_PDEATHSIG, SIGKILL);
        if (fd >= 0 && dup2(fd, STDERR_FILENO) >= 0) {
            (void)execl("/proc/self/exe", "test", "outlets", rig->postgres.conninfo, rig->key_file,
                        (char *)NULL);
        }
        _exit(127);
    }
    return pid;
}

void outlet_rig_kill(pid_t pid)
{
    assert_int_equal(kill(pid, SIGKILL), 0);
    assert_int_equal(waitpid(pid, NULL, 0), pid);
}

static void pause_ms(int ms)
{
    const struct timespec time = {.tv_sec = ms / 1000, .tv_nsec = (long)(ms % 1000) * 1000000};
    (void)nanosleep(&time, NULL);
}

void outlet_rig_end(pid_t pid)
{
    int status = 0;
    pid_t ended = 0;
    assert_int_equal(kill(pid, SIGTERM), 0);
    for (int i = 0; i < 300 && !ended; i++) {
        ended = waitpid(pid, &status, WNOHANG);
        pause_ms(10);
    }
    if (!ended) {
        outlet_rig_kill(pid);
        fail_msg("the process did not end");
    }
    assert_true(WIFEXITED(status));
    assert_int_equal(WEXITSTATUS(status), 0);
}

/* ---- doors and events ---- */

struct iso_fleet_id outlet_rig_door(struct store_rig *rig, const char *name)
{
    struct iso_fault fault = {.text = ""};
    struct hub_values values = {.n = 0};
    const struct iso_fleet_id id = iso_fleet_id_of(name, strlen(name));
    hub_value_id(&values, &id);
    hub_value_text(&values, name);
    store_rig_fine(hub_db_run(rig->store.db,
                              "INSERT INTO door (id, name, added_s) VALUES ($1, $2, 1)", &values,
                              NULL, &fault),
                   &fault);
    return id;
}

void outlet_rig_events(struct store_rig *rig, const struct iso_fleet_id *door, uint64_t from,
                       uint64_t to, const char *event)
{
    struct iso_fault fault = {.text = ""};
    struct hub_values values = {.n = 0};
    hub_value_id(&values, door);
    hub_value_integer(&values, (int64_t)from);
    hub_value_integer(&values, (int64_t)to);
    hub_value_text(&values, event);
    store_rig_fine(
        hub_db_run(rig->store.db,
                   "WITH stored AS (INSERT INTO event (door, number, time, record) SELECT $1, n, "
                   "'2026-11-21T08:30:15.250Z', jsonb_build_object('sequence', n, 'event', $4, "
                   "'time', '2026-11-21T08:30:15.250Z') FROM generate_series($2, $3) n) "
                   "UPDATE door SET acked = $3 WHERE id = $1",
                   &values, NULL, &fault),
        &fault);
}

struct search {
    const char *name;
    bool found;
    struct hub_outlet outlet;
};

static int look(void *context, const struct hub_outlet *outlet)
{
    struct search *search = context;
    if (strcmp(outlet->name, search->name) == 0) {
        search->found = true;
        search->outlet = *outlet;
    }
    return 0;
}

struct hub_outlet outlet_rig_outlet(struct store_rig *rig, const char *name)
{
    struct iso_fault fault = {.text = ""};
    struct search search = {.name = name};
    store_rig_fine(hub_outlet_each(&rig->store, look, &search, &fault), &fault);
    assert_true(search.found);
    return search.outlet;
}

void outlet_rig_wait_idle(struct store_rig *rig, const char *name, double seconds)
{
    struct hub_outlet outlet = outlet_rig_outlet(rig, name);
    for (int i = 0; i < (int)(100 * seconds) && outlet.waiting > 0; i++) {
        pause_ms(10);
        outlet = outlet_rig_outlet(rig, name);
    }
    if (outlet.waiting > 0) {
        fail_msg("%s: %" PRIu64 " events wait; %" PRIu64 " failures: %s", name, outlet.waiting,
                 outlet.failures, outlet.trouble);
    }
}
