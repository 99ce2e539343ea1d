/* Which client may call which method of the daemon. A private bus reads the installed policies. A
 * stand-in for the daemon answers every call. One client is in each group of the policy, one is the
 * web server, and one is the link to a hub. Groups and users that every Debian has replace those of
 * the policies. The test needs root, because it changes its user. */
#include <errno.h>
#include <grp.h>
#include <pwd.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <systemd/sd-bus.h>
#include <unistd.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "firmware/contract/contract.h"
#include "firmware/contract/fleet_words.h"
#include "tests/support/child_end.h"
#include "tests/support/programs/private_bus.h"
#include "tests/support/scratch.h"

#define POLICY      ISOTHERM_SOURCE_DIR "/board/generic/org.isotherm.Isotherm.conf"
#define WEB_POLICY  ISOTHERM_SOURCE_DIR "/board/generic/org.isotherm.Web.conf"
#define WEB_USER    "www-data" /* takes the place of isotherm-web */
#define LINK_POLICY ISOTHERM_SOURCE_DIR "/board/generic/org.isotherm.Link.conf"
#define LINK_USER   "uucp" /* takes the place of isotherm-link */

enum { NOBODY_UID = 65534, ALLOWED = 0, DENIED = 1, CONFUSED = 2 };

static const char *const groups[][2] = {
    {"isotherm-observe", "games"},
    {"isotherm-identify", "audio"},
    {"isotherm-enroll", "video"},
    {"isotherm", "floppy"},
};

/* The one method of another interface; libsystemd answers it in the daemon. */
#define INTROSPECT "Introspect"

enum rank { OBSERVE = 0, IDENTIFY, ENROLL, ADMINISTER, NO_GROUP, WEB_SERVER, LINK, RANKS };

static const char *const ranks[RANKS] = {
    "isotherm-observe", "isotherm-identify", "isotherm-enroll", "isotherm",
    "nobody",           "isotherm-web",      "isotherm-link",
};

static const struct {
    const char *method;
    bool may[RANKS];
} rules[] = {
    {INTROSPECT, {true, true, true, true, false, false, false}},
    {ISO_CONTRACT_GET_STATUS, {true, true, true, true, false, true, false}},
    {ISO_CONTRACT_GET_SITE, {true, true, true, true, false, true, false}},
    {ISO_CONTRACT_LIST_LOOK_ALIKES, {false, false, true, true, false, false, false}},
    {ISO_CONTRACT_LIST_OTHER, {false, false, true, true, false, false, false}},
    {ISO_CONTRACT_RESET_SITE, {false, false, false, true, false, false, false}},
    {ISO_CONTRACT_ROLL_BACK_SITE, {false, false, false, true, false, false, false}},
    {ISO_CONTRACT_GET_POLICY, {false, false, false, true, false, true, false}},
    {ISO_CONTRACT_SET_POLICY, {false, false, false, true, false, true, false}},
    {ISO_CONTRACT_CHECK_POLICY, {false, false, false, true, false, true, false}},
    {ISO_CONTRACT_TEST_ACCESS, {false, false, false, true, false, true, false}},
    {ISO_CONTRACT_GET_CREDENTIAL, {false, false, false, true, false, true, false}},
    {ISO_CONTRACT_SET_CREDENTIAL, {false, false, false, true, false, true, false}},
    {ISO_CONTRACT_LIST_CREDENTIALS, {false, false, false, true, false, true, false}},
    {ISO_CONTRACT_RECORD_ACT, {false, false, false, true, false, true, false}},
    {ISO_CONTRACT_AIM_START, {true, false, false, true, false, false, false}},
    {ISO_CONTRACT_AIM_STOP, {true, false, false, true, false, false, false}},
    {ISO_CONTRACT_CLAIM, {false, true, true, true, false, true, false}},
    {ISO_CONTRACT_RELEASE, {false, true, true, true, false, true, false}},
    {ISO_CONTRACT_IDENTIFY_START, {false, true, false, true, false, false, false}},
    {ISO_CONTRACT_IDENTIFY_STOP, {false, true, false, true, false, false, false}},
    {ISO_CONTRACT_VERIFY_START, {false, true, false, true, false, false, false}},
    {ISO_CONTRACT_VERIFY_STOP, {false, true, false, true, false, false, false}},
    {ISO_CONTRACT_ENROLL_START, {false, false, true, true, false, true, false}},
    {ISO_CONTRACT_ENROLL_STOP, {false, false, true, true, false, true, false}},
    {ISO_CONTRACT_VERIFY_SELF, {true, true, true, true, true, true, true}},
    {ISO_CONTRACT_VERIFY_LOGIN, {false, false, false, true, false, false, false}},
    {ISO_CONTRACT_LIST_PEOPLE, {false, false, true, true, false, true, false}},
    {ISO_CONTRACT_DELETE_PERSON, {false, false, false, true, false, true, false}},
    {ISO_CONTRACT_SET_VALIDITY, {false, false, false, true, false, true, false}},
    {ISO_CONTRACT_RENAME_PERSON, {false, false, false, true, false, true, false}},
    {ISO_CONTRACT_READ_LOG, {false, false, false, true, false, true, false}},
    {ISO_CONTRACT_CLEAR_LOCKOUT, {false, false, false, true, false, true, false}},
    {ISO_CONTRACT_PICTURE, {false, false, false, true, false, false, false}},
    {ISO_CONTRACT_SET_LOCKDOWN, {false, false, false, true, false, true, false}},
    {ISO_CONTRACT_TEST_DOOR, {false, false, false, true, false, false, false}},
    {ISO_CONTRACT_INSTALL_PANEL, {false, false, false, true, false, false, false}},
    {ISO_CONTRACT_RECORD_COMMISSION, {false, false, false, true, false, false, false}},
    {ISO_CONTRACT_WATCH, {true, false, false, true, false, true, false}},
    {ISO_CONTRACT_WATCH_RELIEF, {false, false, true, true, false, true, false}},
    {ISO_CONTRACT_VERIFY_LOG, {false, false, false, true, false, true, false}},
    {ISO_CONTRACT_EXPORT_PEOPLE, {false, false, false, true, false, false, false}},
    {ISO_CONTRACT_IMPORT_PEOPLE, {false, false, false, true, false, false, false}},
    {ISO_CONTRACT_ROTATE_KEYS, {false, false, false, true, false, false, false}},
    {ISO_CONTRACT_GET_ADDRESS, {false, false, false, true, false, false, false}},
    {ISO_CONTRACT_GET_SETTINGS, {false, false, false, true, false, true, false}},
    {ISO_CONTRACT_SET_SETTING, {false, false, false, true, false, true, false}},
    {ISO_CONTRACT_RESET_SETTING, {false, false, false, true, false, true, false}},
    {ISO_CONTRACT_GET_FLEET, {false, false, false, false, false, false, true}},
    {ISO_CONTRACT_FLEET_JOIN, {false, false, false, false, false, false, false}},
    {ISO_CONTRACT_FLEET_LEAVE, {false, false, false, false, false, false, false}},
    {ISO_CONTRACT_FLEET_QUESTION, {false, false, false, false, false, false, true}},
    {ISO_CONTRACT_FLEET_RECEIVE, {false, false, false, false, false, false, true}},
    {ISO_CONTRACT_FLEET_FETCH, {false, false, false, false, false, false, true}},
    {ISO_CONTRACT_FLEET_SNAPSHOT, {false, false, false, false, false, false, true}},
    {ISO_CONTRACT_FLEET_EVENTS, {false, false, false, false, false, false, true}},
    {ISO_CONTRACT_FLEET_REQUESTS, {false, false, false, false, false, false, true}},
    {ISO_CONTRACT_FLEET_UPDATE, {false, false, false, false, false, false, true}},
    {ISO_CONTRACT_FLEET_FETCH_UPDATE, {false, false, false, false, false, false, true}},
};

enum { RULES = sizeof rules / sizeof *rules };

static struct private_bus private;
static pid_t server;

/* ---- the policy, with groups that exist ---- */

static void replace(char *text, size_t size, const char *from, const char *to)
{
    char *at = strstr(text, from);
    assert_non_null(at);
    const size_t rest = strlen(at + strlen(from)) + 1;
    assert_true((size_t)(at - text) + strlen(to) + rest <= size);
    memmove(at + strlen(to), at + strlen(from), rest);
    memcpy(at, to, strlen(to));
}

/* The text of a policy, with room for as much again. The caller frees it. */
static char *read_policy(const char *path, size_t *size)
{
    char *file = scratch_read_text(path);
    *size = 2 * strlen(file) + 1;
    char *text = calloc(1, *size);
    assert_non_null(text);
    (void)snprintf(text, *size, "%s", file);
    free(file);
    return text;
}

static void write_policy(const char *path)
{
    size_t size;
    char *text = read_policy(POLICY, &size);
    for (size_t i = 0; i < sizeof groups / sizeof *groups; i++) {
        char from[64], to[64];
        (void)snprintf(from, sizeof from, "<policy group=\"%s\">", groups[i][0]);
        (void)snprintf(to, sizeof to, "<policy group=\"%s\">", groups[i][1]);
        replace(text, size, from, to);
    }
    replace(text, size, "<policy user=\"isotherm\">", "<policy user=\"daemon\">");
    scratch_write_text(path, text);
    free(text);
}

/* A policy of one user, whose name is replaced by that of a user that every Debian has. */
static void write_user_policy(const char *from, const char *user, const char *other,
                              const char *path)
{
    size_t size;
    char *text = read_policy(from, &size);
    replace(text, size, user, other);
    scratch_write_text(path, text);
    free(text);
}

/* ---- both ends ---- */

static sd_bus *connect_bus(void)
{
    sd_bus *bus = NULL;
    int r = sd_bus_new(&bus);
    r = r < 0 ? r : sd_bus_set_address(bus, private.address);
    r = r < 0 ? r : sd_bus_set_bus_client(bus, 1);
    return r < 0 || sd_bus_start(bus) < 0 ? NULL : bus;
}

static int answer(sd_bus_message *message, void *context, sd_bus_error *error)
{
    (void)context;
    (void)error;
    return sd_bus_message_is_method_call(message, NULL, NULL)
               ? sd_bus_reply_method_return(message, NULL)
               : 0;
}

static void serve(int ready)
{
    sd_bus *bus = connect_bus();
    if (!bus || sd_bus_add_filter(bus, NULL, answer, NULL) < 0 ||
        sd_bus_request_name(bus, ISO_CONTRACT_NAME, 0) < 0 || write(ready, "r", 1) != 1) {
        _exit(1);
    }
    for (;;) {
        while (sd_bus_process(bus, NULL) > 0) {
        }
        (void)sd_bus_wait(bus, UINT64_MAX);
    }
}

static int group_setup(void **state)
{
    int ready[2];
    char byte;
    (void)state;
    if (geteuid() != 0 || !private_bus_start(&private)) {
        return 0;
    }
    char policy[128], web_policy[128], link_policy[128];
    (void)snprintf(policy, sizeof policy, "%s/policy.conf", private.directory);
    (void)snprintf(web_policy, sizeof web_policy, "%s/web_policy.conf", private.directory);
    (void)snprintf(link_policy, sizeof link_policy, "%s/link_policy.conf", private.directory);
    private_bus_kill(&private);
    write_policy(policy);
    write_user_policy(WEB_POLICY, "<policy user=\"isotherm-web\">",
                      "<policy user=\"" WEB_USER "\">", web_policy);
    write_user_policy(LINK_POLICY, "<policy user=\"isotherm-link\">",
                      "<policy user=\"" LINK_USER "\">", link_policy);
    private_bus_include(&private, policy);
    private_bus_include(&private, web_policy);
    private_bus_include(&private, link_policy);
    assert_int_equal(chmod(private.directory, 0755), 0);
    assert_true(private_bus_revive(&private));
    assert_int_equal(pipe(ready), 0);
    server = fork();
    assert_true(server >= 0);
    if (server == 0) {
        serve(ready[1]);
    }
    close(ready[1]);
    assert_int_equal(read(ready[0], &byte, 1), 1);
    close(ready[0]);
    (void)unlink(policy);
    (void)unlink(web_policy);
    (void)unlink(link_policy);
    return 0;
}

static int group_teardown(void **state)
{
    (void)state;
    if (server > 0) {
        kill(server, SIGKILL);
        waitpid(server, NULL, 0);
        private_bus_stop(&private);
    }
    return 0;
}

/* Becomes a user with no group but that of the rank; the web server and the link are users of their
 * own. */
static bool become(enum rank rank)
{
    uid_t uid = NOBODY_UID;
    gid_t gid = NOBODY_UID;
    if (rank == WEB_SERVER || rank == LINK) {
        const struct passwd *user = getpwnam(rank == LINK ? LINK_USER : WEB_USER);
        uid = user ? user->pw_uid : 0;
    } else if (rank < NO_GROUP) {
        const struct group *group = getgrnam(groups[rank][1]);
        gid = group ? group->gr_gid : 0;
    }
    return uid && gid && !setgroups(1, &gid) && !setgid(NOBODY_UID) && !setuid(uid);
}

/* Runs in a child process, which becomes a client of this rank. Writes one verdict for each rule.
 */
static void ask_all(enum rank rank, uint8_t verdicts[RULES])
{
    sd_bus *bus;
    if (!become(rank) || !(bus = connect_bus())) {
        fprintf(stderr, "cannot become the client %s on the bus: %s\n", ranks[rank],
                strerror(errno));
        _exit(1);
    }
    for (int i = 0; i < RULES; i++) {
        sd_bus_error error = SD_BUS_ERROR_NULL;
        const char *interface = strcmp(rules[i].method, INTROSPECT) == 0
                                    ? "org.freedesktop.DBus.Introspectable"
                                    : ISO_CONTRACT_INTERFACE;
        const int r = sd_bus_call_method(bus, ISO_CONTRACT_NAME, ISO_CONTRACT_PATH, interface,
                                         rules[i].method, &error, NULL, "");
        verdicts[i] = r >= 0 ? ALLOWED : CONFUSED;
        if (sd_bus_error_has_name(&error, SD_BUS_ERROR_ACCESS_DENIED)) {
            verdicts[i] = DENIED;
        }
        if (verdicts[i] == CONFUSED) {
            fprintf(stderr, "%s: %s\n", rules[i].method, error.name ? error.name : strerror(-r));
        }
        sd_bus_error_free(&error);
    }
}

static void expect_rights(enum rank rank)
{
    uint8_t verdicts[RULES];
    struct child child;
    int out[2];
    assert_int_equal(pipe(out), 0);
    if (child_fork(&child, "a client that calls every method") == 0) {
        ask_all(rank, verdicts);
        _exit(write(out[1], verdicts, sizeof verdicts) != (ssize_t)sizeof verdicts);
    }
    close(out[1]);
    child_expect(&child, 0);
    assert_int_equal(read(out[0], verdicts, sizeof verdicts), sizeof verdicts);
    close(out[0]);
    for (int i = 0; i < RULES; i++) {
        if (verdicts[i] != (rules[i].may[rank] ? ALLOWED : DENIED)) {
            fail_msg("%s: verdict %d for %s", rules[i].method, verdicts[i], ranks[rank]);
        }
    }
}

static void each_rank_may_call_its_methods(void **state)
{
    (void)state;
    if (server <= 0) {
        print_message("skipped: needs root and a dbus-daemon\n");
        skip();
    }
    for (int rank = OBSERVE; rank < RANKS; rank++) {
        expect_rights((enum rank)rank);
    }
}

/* The answer to an enrolment contains the person whose face is a duplicate, and since when a name
 * is in use. The test above has compared the table of rules with the policy. */
static void every_rank_that_may_enrol_may_list(void **state)
{
    const bool *enrol = NULL, *list = NULL;
    (void)state;
    for (int i = 0; i < RULES; i++) {
        enrol = strcmp(rules[i].method, ISO_CONTRACT_ENROLL_START) == 0 ? rules[i].may : enrol;
        list = strcmp(rules[i].method, ISO_CONTRACT_LIST_PEOPLE) == 0 ? rules[i].may : list;
    }
    assert_non_null(enrol);
    assert_non_null(list);
    for (int rank = OBSERVE; rank < RANKS; rank++) {
        assert_true(list[rank] || !enrol[rank]);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(each_rank_may_call_its_methods),
                                       cmocka_unit_test(every_rank_that_may_enrol_may_list)};
    return cmocka_run_group_tests(tests, group_setup, group_teardown);
}
