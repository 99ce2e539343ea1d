/* Who may ask RAUC for what in the image: a private bus reads the policy of the image, and clients
 * with other users and groups call each method. Groups and users that every Debian has replace
 * those of the policy. The test needs root, because it changes its user. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <errno.h>
#include <grp.h>
#include <pwd.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <systemd/sd-bus.h>
#include <unistd.h>

#include "tests/enroll/rigs/fake_rauc.h"
#include "tests/support/child_end.h"
#include "tests/support/programs/private_bus.h"
#include "tests/support/scratch.h"

#define POLICY     ISOTHERM_SOURCE_DIR "/board/image/etc/de.pengutronix.rauc.conf"
#define INSTALLER  "de.pengutronix.rauc.Installer"
#define PROPERTIES "org.freedesktop.DBus.Properties"

enum { NOBODY_GID = 65534 };

/* Who calls: "floppy" takes the place of the group isotherm, "daemon" that of the user, "www-data"
 * that of the user isotherm-web, and "games" that of isotherm-link. */
enum caller { ROOT, ADMINISTRATOR, DAEMON, WEB, LINK, NOBODY, CALLERS };

static const char *const callers[CALLERS] = {"root",           "an administrator", "the daemon",
                                             "the web server", "the link",         "nobody"};

static const struct {
    const char *interface, *method;
    bool may[CALLERS];
} rules[] = {
    {PROPERTIES, "GetAll", {true, true, false, true, true, false}},
    {PROPERTIES, "Set", {true, true, false, false, false, false}},
    {INSTALLER, "Info", {true, true, false, false, false, false}},
    {INSTALLER, "InstallBundle", {true, true, false, false, false, false}},
    {INSTALLER, "GetSlotStatus", {true, true, false, true, true, false}},
    {INSTALLER, "GetPrimary", {true, true, false, true, true, false}},
    {INSTALLER, "Mark", {true, false, false, false, false, false}},
    {INSTALLER, "Install", {true, false, false, false, false, false}},
};

static struct private_bus bus;

/* Writes the policy to a file, with one word replaced. */
static char *replace(char *text, const char *from, const char *to)
{
    const char *at = strstr(text, from);
    const size_t size = strlen(text) + strlen(to) + 1;
    char *out = malloc(size);

    assert_non_null(at);
    assert_non_null(out);
    (void)snprintf(out, size, "%.*s%s%s", (int)(at - text), text, to, at + strlen(from));
    free(text);
    return out;
}

static void include_policy(void)
{
    char path[96];
    char *text = scratch_read_text(POLICY);

    text = replace(text, "<policy group=\"isotherm\">", "<policy group=\"floppy\">");
    text = replace(text, "<policy user=\"isotherm\">", "<policy user=\"daemon\">");
    text = replace(text, "<policy user=\"isotherm-web\">", "<policy user=\"www-data\">");
    text = replace(text, "<policy user=\"isotherm-link\">", "<policy user=\"games\">");
    (void)snprintf(path, sizeof path, "%s/policy.conf", bus.directory);
    private_bus_kill(&bus);
    scratch_write_text(path, text);
    private_bus_include(&bus, path);
    free(text);
    assert_int_equal(chmod(bus.directory, 0755), 0);
    assert_true(private_bus_revive(&bus));
    assert_int_equal(unlink(path), 0);
}

/* Becomes the caller, in a child. The daemon is also in the group of the administrators. */
static bool become(enum caller caller)
{
    static const char *const users[CALLERS] = {[ADMINISTRATOR] = "nobody",
                                               [DAEMON] = "daemon",
                                               [WEB] = "www-data",
                                               [LINK] = "games",
                                               [NOBODY] = "nobody"};
    const struct group *administrators = getgrnam("floppy");
    const struct passwd *user = caller == ROOT ? NULL : getpwnam(users[caller]);
    const bool member = caller == ADMINISTRATOR || caller == DAEMON;

    if (caller == ROOT) {
        return true;
    }
    if (!administrators || !user || setgroups(member, &administrators->gr_gid) < 0) {
        return false;
    }
    return !setgid(NOBODY_GID) && !setuid(user->pw_uid);
}

static sd_bus *connect_bus(void)
{
    sd_bus *out = NULL;
    int r = sd_bus_new(&out);
    r = r < 0 ? r : sd_bus_set_address(out, bus.address);
    r = r < 0 ? r : sd_bus_set_bus_client(out, 1);
    return r < 0 || sd_bus_start(out) < 0 ? NULL : out;
}

/* Whether each call agrees with the rules. A call that reaches the stand-in may fail for another
 * reason, such as its arguments. Runs in a child. */
static int count_wrong(enum caller caller)
{
    sd_bus *client = become(caller) ? connect_bus() : NULL;
    int wrong = client ? 0 : 100;

    for (size_t i = 0; client && i < sizeof rules / sizeof *rules; i++) {
        sd_bus_error error = SD_BUS_ERROR_NULL;
        (void)sd_bus_call_method(client, "de.pengutronix.rauc", "/", rules[i].interface,
                                 rules[i].method, &error, NULL, "");
        const bool may = !sd_bus_error_has_name(&error, SD_BUS_ERROR_ACCESS_DENIED);
        if (may != rules[i].may[caller]) {
            fprintf(stderr, "%s: %s %s\n", rules[i].method, callers[caller],
                    may ? "may, and should not" : "may not, and should");
            wrong++;
        }
        sd_bus_error_free(&error);
    }
    sd_bus_flush_close_unref(client);
    return wrong;
}

static void each_caller_may_call_its_methods(void **state)
{
    static const struct fake_rauc_script sound;
    struct fake_rauc rauc;

    (void)state;
    if (geteuid() != 0) {
        print_message("skipped: needs root\n");
        skip();
    }
    include_policy();
    fake_rauc_start(&rauc, bus.address, &sound);
    for (enum caller caller = ROOT; caller < CALLERS; caller++) {
        struct child child;
        if (child_fork(&child, callers[caller]) == 0) {
            _exit(count_wrong(caller));
        }
        child_expect(&child, 0);
    }
    (void)fake_rauc_stop(&rauc);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(each_caller_may_call_its_methods)};

    if (!private_bus_start(&bus)) {
        return TEST_SKIPPED;
    }
    const int failed = cmocka_run_group_tests(tests, NULL, NULL);
    private_bus_stop(&bus);
    return failed;
}
