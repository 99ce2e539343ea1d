#include "tests/enroll/hub/directory/rig_slapd.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <arpa/inet.h>
#include <ldap.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "tests/enroll/hub/outlet/receiver.h"
#include "tests/support/scratch.h"

static const char program[] = "/usr/sbin/slapd";

static unsigned free_port(void)
{
    struct sockaddr_in name = {.sin_family = AF_INET, .sin_addr.s_addr = htonl(INADDR_LOOPBACK)};
    socklen_t size = sizeof name;
    const int fd = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    assert_true(fd >= 0);
    assert_int_equal(bind(fd, (struct sockaddr *)&name, sizeof name), 0);
    assert_int_equal(getsockname(fd, (struct sockaddr *)&name, &size), 0);
    (void)close(fd);
    return ntohs(name.sin_port);
}

static void write_config(const struct rig_slapd *rig)
{
    static struct receiver_pair pair;
    char config[2048];
    receiver_pair_make(&pair);
    scratch_write_text(rig->certificate, pair.certificate);
    scratch_write_text(scratch_path(rig->directory, "key.pem"), pair.key);
    (void)snprintf(config, sizeof config,
                   "include /etc/ldap/schema/core.schema\n"
                   "include /etc/ldap/schema/cosine.schema\n"
                   "include /etc/ldap/schema/inetorgperson.schema\n"
                   "modulepath /usr/lib/ldap\n"
                   "moduleload back_mdb\n"
                   "moduleload memberof\n"
                   "sizelimit size.pr=unlimited size.soft=600 size.hard=600\n"
                   "TLSCertificateFile %s\n"
                   "TLSCertificateKeyFile %s/key.pem\n"
                   "database mdb\n"
                   "suffix " RIG_SLAPD_BASE "\n"
                   "rootdn " RIG_SLAPD_ROOT "\n"
                   "rootpw \"" RIG_SLAPD_PASSWORD "\"\n"
                   "directory %s\n"
                   "dbnosync\n"
                   "access to attrs=userPassword by * none\n"
                   "access to * by users read by * none\n"
                   "overlay memberof\n",
                   rig->certificate, rig->directory, rig->directory);
    scratch_write_text(scratch_path(rig->directory, "slapd.conf"), config);
}

/* A connection of the administrator. */
static LDAP *administer(const struct rig_slapd *rig)
{
    struct berval password = {.bv_val = (char *)(uintptr_t)RIG_SLAPD_PASSWORD,
                              .bv_len = strlen(RIG_SLAPD_PASSWORD)};
    const int version = LDAP_VERSION3;
    LDAP *ldap = NULL;
    assert_int_equal(ldap_initialize(&ldap, rig->uri), 0);
    assert_int_equal(ldap_set_option(ldap, LDAP_OPT_PROTOCOL_VERSION, &version), 0);
    for (int i = 0; ldap_sasl_bind_s(ldap, RIG_SLAPD_ROOT, LDAP_SASL_SIMPLE, &password, NULL, NULL,
                                     NULL) != LDAP_SUCCESS;
         i++) {
        const struct timespec pause = {.tv_nsec = 20000000};
        assert_true(i < 500);
        (void)nanosleep(&pause, NULL);
    }
    return ldap;
}

static void check(int code, const char *what)
{
    if (code) {
        fail_msg("%s: %s", what, ldap_err2string(code));
    }
}

enum { ATTRIBUTES = 6 };

/* One entry from pairs of attribute and value, up to NULL. */
static void add_entry(LDAP *ldap, const char *dn, const char *const pairs[])
{
    LDAPMod mods[ATTRIBUTES], *list[ATTRIBUTES + 1] = {NULL};
    char *values[ATTRIBUTES][2];
    for (size_t i = 0; pairs[2 * i]; i++) {
        assert_true(i < ATTRIBUTES);
        values[i][0] = (char *)(uintptr_t)pairs[2 * i + 1];
        values[i][1] = NULL;
        mods[i] = (LDAPMod){.mod_op = LDAP_MOD_ADD,
                            .mod_type = (char *)(uintptr_t)pairs[2 * i],
                            .mod_values = values[i]};
        list[i] = &mods[i];
    }
    check(ldap_add_ext_s(ldap, dn, list, NULL, NULL), dn);
}

static void add_tree(const struct rig_slapd *rig)
{
    static const char *const groups[] = {"staff", "night", "other"};
    LDAP *ldap = administer(rig);
    add_entry(ldap, RIG_SLAPD_BASE,
              (const char *const[]){"objectClass", "domain", "dc", "example", NULL});
    add_entry(ldap, "ou=people," RIG_SLAPD_BASE,
              (const char *const[]){"objectClass", "organizationalUnit", "ou", "people", NULL});
    for (size_t i = 0; i < 3; i++) {
        char dn[128];
        (void)snprintf(dn, sizeof dn, "cn=%s," RIG_SLAPD_BASE, groups[i]);
        add_entry(ldap, dn,
                  (const char *const[]){"objectClass", "groupOfNames", "cn", groups[i], "member",
                                        RIG_SLAPD_ROOT, NULL});
    }
    (void)ldap_unbind_ext_s(ldap, NULL, NULL);
}

bool rig_slapd_start(struct rig_slapd *rig)
{
    char listen[192];
    *rig = (struct rig_slapd){.pid = 0};
    if (access(program, X_OK)) {
        print_message("slapd is not installed; its tests are left out\n");
        return false;
    }
    strcpy(rig->directory, "/tmp/isotherm-slapd-XXXXXX");
    assert_non_null(mkdtemp(rig->directory));
    (void)snprintf(rig->uri, sizeof rig->uri, "ldap://127.0.0.1:%u", free_port());
    (void)snprintf(rig->tls_uri, sizeof rig->tls_uri, "ldaps://127.0.0.1:%u", free_port());
    (void)snprintf(rig->certificate, sizeof rig->certificate, "%s/certificate.pem", rig->directory);
    (void)snprintf(listen, sizeof listen, "%s %s", rig->uri, rig->tls_uri);
    write_config(rig);
    rig->pid = fork();
    assert_true(rig->pid >= 0);
    if (rig->pid == 0) {
        (void)prctl(PR_SET_PDEATHSIG, SIGKILL);
        (void)execl(program, program, "-f", scratch_path(rig->directory, "slapd.conf"), "-h",
                    listen, "-d", "0", (char *)NULL);
        _exit(127);
    }
    add_tree(rig);
    return true;
}

void rig_slapd_stop(struct rig_slapd *rig)
{
    static const char *const files[] = {"slapd.conf", "certificate.pem", "key.pem", "data.mdb",
                                        "lock.mdb"};
    if (rig->pid) {
        assert_int_equal(kill(rig->pid, SIGTERM), 0);
        assert_int_equal(waitpid(rig->pid, NULL, 0), rig->pid);
    }
    for (size_t i = 0; i < sizeof files / sizeof *files; i++) {
        (void)unlink(scratch_path(rig->directory, files[i]));
    }
    assert_int_equal(rmdir(rig->directory), 0);
}

static const char *dn_of(const char *uid, char dn[128])
{
    (void)snprintf(dn, 128, "uid=%s,ou=people," RIG_SLAPD_BASE, uid);
    return dn;
}

void rig_slapd_add(struct rig_slapd *rig, const char *uid, const char *name)
{
    char dn[128];
    LDAP *ldap = administer(rig);
    add_entry(ldap, dn_of(uid, dn),
              (const char *const[]){"objectClass", "inetOrgPerson", "uid", uid, "cn", name, "sn",
                                    name, NULL});
    (void)ldap_unbind_ext_s(ldap, NULL, NULL);
}

void rig_slapd_delete(struct rig_slapd *rig, const char *uid)
{
    char dn[128];
    LDAP *ldap = administer(rig);
    check(ldap_delete_ext_s(ldap, dn_of(uid, dn), NULL, NULL), dn);
    (void)ldap_unbind_ext_s(ldap, NULL, NULL);
}

static void modify(struct rig_slapd *rig, const char *dn, int operation, const char *attribute,
                   const char *value)
{
    char *values[] = {(char *)(uintptr_t)value, NULL};
    LDAPMod mod = {.mod_op = operation,
                   .mod_type = (char *)(uintptr_t)attribute,
                   .mod_values = value ? values : NULL};
    LDAPMod *list[] = {&mod, NULL};
    LDAP *ldap = administer(rig);
    check(ldap_modify_ext_s(ldap, dn, list, NULL, NULL), dn);
    (void)ldap_unbind_ext_s(ldap, NULL, NULL);
}

void rig_slapd_set(struct rig_slapd *rig, const char *uid, const char *attribute, const char *value)
{
    char dn[128];
    modify(rig, dn_of(uid, dn), LDAP_MOD_REPLACE, attribute, value);
}

static void change_group(struct rig_slapd *rig, const char *group, const char *uid, int operation)
{
    char dn[128], member[128];
    (void)snprintf(dn, sizeof dn, "cn=%s," RIG_SLAPD_BASE, group);
    modify(rig, dn, operation, "member", dn_of(uid, member));
}

void rig_slapd_join(struct rig_slapd *rig, const char *group, const char *uid)
{
    change_group(rig, group, uid, LDAP_MOD_ADD);
}

void rig_slapd_leave(struct rig_slapd *rig, const char *group, const char *uid)
{
    change_group(rig, group, uid, LDAP_MOD_DELETE);
}
