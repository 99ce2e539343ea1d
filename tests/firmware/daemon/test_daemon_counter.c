/* The daemon with a counter in a software TPM. It is confined as always. It counts, refuses a state
 * directory of an earlier time in one line, and accepts it when an option says so. */
#include <signal.h>
#include <stdio.h>
#include <string.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "tests/firmware/rigs/file_mix.h"
#include "tests/support/devices/soft_tpm.h"
#include "tests/support/programs/private_bus.h"
#include "tests/support/programs/run.h"
#include "tests/support/scratch.h"

#define DAEMON ISOTHERM_BINARY_DIR "/firmware/isothermd"
#define CLIENT ISOTHERM_BINARY_DIR "/enroll/isotherm"
#define DATA   ISOTHERM_SOURCE_DIR "/core/data"

static struct private_bus bus;
static struct soft_tpm tpm;
static const char *state_directory, *configuration;

static void configure(const char *directory, const char *index)
{
    static char text[2048], path[256], state_path[256];
    (void)snprintf(path, sizeof path, "%s/c.conf", directory);
    (void)snprintf(state_path, sizeof state_path, "%s/state", directory);
    (void)snprintf(text, sizeof text,
                   "[sensor]\npath = %s/slot\n[gallery]\npath = %s/g.db\n[log]\npath = %s/a.log\n"
                   "[seal]\ncounter = tpm2\ncounter_tcti = %s\ncounter_index = %s\n"
                   "[bus]\naddress = %s\n"
                   "[reset]\nweb = %s/web\nlink = %s/link\ncredential = %s/credential\n"
                   "[model]\nhead = " DATA "/head.model\nmetric = " DATA "/face.metric\n",
                   directory, state_path, state_path, tpm.tcti, index, bus.address, directory,
                   directory, directory);
    scratch_write_text(path, text);
    configuration = path;
    state_directory = state_path;
}

static int setup(void **state)
{
    const int error = scratch_setup(state);
    assert_true(soft_tpm_start(&tpm, *state));
    soft_tpm_make_device(&tpm, *state);
    configure(*state, "0x01804953");
    scratch_mkdir(state_directory);
    return error;
}

static int teardown(void **state)
{
    soft_tpm_off(&tpm);
    return scratch_teardown(state);
}

static void start(struct run *run)
{
    const char *const argv[] = {DAEMON, "--config", configuration, NULL};
    run_start(run, argv);
    run_until(run, "ready");
}

static void stop(struct run *run)
{
    assert_int_equal(kill(run->pid, SIGTERM), 0);
    run_finish(run);
    run_expect(run, 0);
    if (strstr(run->err, "counter")) {
        fail_msg("it said: %s", run->err);
    }
    run_free(run);
}

/* Runs the daemon with this option (NULL: none) until it ends by itself with this exit code. On a
 * failure it must print one line with the words on standard error, otherwise the words on standard
 * output. */
static void expect_end(const char *option, int exit, const char *words)
{
    const char *const argv[] = {DAEMON, "--config", configuration, option, NULL};
    struct run run;
    run_start(&run, argv);
    run_finish(&run);
    run_expect(&run, exit);
    const char *said = exit ? run.err : run.out;
    const char *newline = strchr(said, '\n');
    if (!strstr(said, words) || !newline || (exit && newline[1] != '\0')) {
        fail_msg("'%s' is not in: %s", words, said);
    }
    run_free(&run);
}

static void order(const char *verb, const char *object)
{
    const char *const argv[] = {CLIENT, "--bus", bus.address, verb, object, NULL};
    struct run run;
    run_start(&run, argv);
    run_finish(&run);
    run_expect(&run, 0);
    run_free(&run);
}

static void a_directory_of_an_earlier_time_is_refused_and_accepted(void **state)
{
    struct mix_state before;
    struct run run;
    (void)state;
    start(&run);
    stop(&run);
    mix_take(state_directory, &before);
    start(&run);
    order("lockdown", "on");
    order("lockdown", "off");
    stop(&run);
    start(&run);
    stop(&run);
    mix_put_back(state_directory, &before);
    expect_end(NULL, 4, "a.log: the state directory is of an earlier time: its counter says ");
    expect_end("--print-log", 0, "\"event\":\"start\"");
    expect_end("--accept-state", 0, "accepted and put on record");
    expect_end("--accept-state", 0, "nothing to accept");
    start(&run);
    stop(&run);
    expect_end("--print-log", 0, "\"event\":\"state-accepted\"");
    mix_let_go(&before);
}

/* The counter counts on. A reset must not leave an appliance that nobody can start. */
static void a_factory_reset_needs_no_further_permission(void **state)
{
    struct mix_state before, now;
    struct run run;
    (void)state;
    start(&run);
    order("lockdown", "on");
    order("lockdown", "off");
    stop(&run);
    mix_take(state_directory, &before);
    expect_end("--factory-reset", 0, "the appliance is reset");
    start(&run);
    assert_int_equal(kill(run.pid, SIGKILL), 0); /* a power cut */
    run_finish(&run);
    run_free(&run);
    soft_tpm_off(&tpm);
    soft_tpm_on(&tpm);
    start(&run);
    stop(&run);
    mix_take(state_directory, &now);
    assert_null(mix_find(&now, "factory-reset.done"));
    mix_let_go(&now);
    mix_put_back(state_directory, &before);
    expect_end(NULL, 4, "the state directory is of an earlier time");
    mix_let_go(&before);
}

/* The kill may come at any time, also while an increment is under way. */
static void a_power_cut_is_no_reason_to_refuse(void **state)
{
    struct run run;
    (void)state;
    for (int i = 0; i < 3; i++) {
        start(&run);
        order("lockdown", i % 2 ? "off" : "on");
        assert_int_equal(kill(run.pid, SIGKILL), 0);
        run_finish(&run);
        run_free(&run);
        soft_tpm_off(&tpm);
        soft_tpm_on(&tpm);
    }
    start(&run);
    stop(&run);
}

static void without_its_tpm_it_does_not_start(void **state)
{
    struct run run;
    (void)state;
    start(&run);
    stop(&run);
    soft_tpm_off(&tpm);
    expect_end(NULL, 4, "the TPM at device:/");
    expect_end("--accept-state", 4, "/tpm0: No such file or directory");
    expect_end("--print-log", 0, "\"event\":\"stop\"");
    soft_tpm_on(&tpm);
    start(&run);
    stop(&run);
    soft_tpm_replace(&tpm);
    expect_end(NULL, 4, "the counter of the state is gone from the TPM");
}

/* The door continues without the counter. The fault is reported until the TPM works again. */
static void a_tpm_that_is_lost_later_is_reported(void **state)
{
    const char *const argv[] = {CLIENT, "--bus", bus.address, "doctor", "--json", NULL};
    struct run run, doctor;
    (void)state;
    start(&run);
    soft_tpm_off(&tpm);
    order("lockdown", "on");
    run_until(&run, "the counter of the state stands still");
    run_start(&doctor, argv);
    run_finish(&doctor);
    if (!strstr(doctor.out, "the TPM at") || !strstr(doctor.out, "\"tpm-failed\"")) {
        fail_msg("the doctor says: %s", doctor.out);
    }
    run_free(&doctor);
    soft_tpm_on(&tpm);
    run_until(&run, "the counter of the state works again");
    assert_int_equal(kill(run.pid, SIGTERM), 0);
    run_finish(&run);
    run_expect(&run, 0);
    run_free(&run);
    start(&run);
    stop(&run);
}

static void a_wrong_index_is_refused(void **state)
{
    configure(*state, "0x81000001");
    expect_end("--check-config", 2,
               "[seal] counter_index: '0x81000001' is not an index of the owner of a TPM");
    expect_end(NULL, 2, "[seal] counter_index: ");
}

int main(void)
{
#define TEST(f) cmocka_unit_test_setup_teardown(f, setup, teardown)
    const struct CMUnitTest tests[] = {
        TEST(a_directory_of_an_earlier_time_is_refused_and_accepted),
        TEST(a_factory_reset_needs_no_further_permission),
        TEST(a_power_cut_is_no_reason_to_refuse),
        TEST(without_its_tpm_it_does_not_start),
        TEST(a_tpm_that_is_lost_later_is_reported),
        TEST(a_wrong_index_is_refused),
    };
    void *directory = NULL;
    if (scratch_setup(&directory)) {
        return 1;
    }
    const bool there = soft_tpm_start(&tpm, directory);
    soft_tpm_off(&tpm);
    (void)scratch_teardown(&directory);
    if (!there || !private_bus_start(&bus)) {
        return TEST_SKIPPED;
    }
    const int failed = cmocka_run_group_tests(tests, NULL, NULL);
    private_bus_stop(&bus);
    return failed;
}
