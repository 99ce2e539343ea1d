#include "tests/enroll/hub/rigs/hub_rig.h"

#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "enroll/hub/broker/broker_config.h"
#include "enroll/hub/store/hub_door.h"
#include "enroll/hub/store/hub_schema.h"
#include "enroll/hub/store/hub_zone.h"
#include "tests/support/scratch.h"

#define HUB_PROCESS ISOTHERM_BINARY_DIR "/tests/enroll/hub/serve/hub_process"

static void ok(int error, const struct iso_fault *fault)
{
    if (error) {
        fail_msg("%d: %s", error, fault->text);
    }
}

static struct rig_postgres postgres;

static bool start_postgres(struct hub_rig *rig)
{
    rig->postgres = &postgres;
    return postgres.pid != 0 || rig_postgres_start(&postgres);
}

int hub_rig_end(void **state)
{
    (void)state;
    rig_postgres_stop(&postgres);
    return 0;
}

static void make_store(struct hub_rig *rig)
{
    struct iso_fault fault = {.text = ""};
    struct hub_keys keys;
    struct hub_db *db = NULL;
    const char *key_file = scratch_path(rig->folder, "hub.keys");

    ok(hub_keys_make(key_file, &keys, &fault), &fault);
    hub_keys_wipe(&keys);
    ok(hub_db_open(rig->postgres->conninfo, &db, &fault), &fault);
    ok(hub_schema_migrate(db, (int64_t)hub_migrations_n, &fault), &fault);
    hub_db_close(db);
    const struct hub_store_options options = {.conninfo = rig->postgres->conninfo,
                                              .key_file = key_file,
                                              .hub_name = "Test",
                                              .actor = "anna"};
    ok(hub_store_open(&options, &rig->store, &fault), &fault);
    ok(hub_zone_add(&rig->store, "Office", &rig->zone, &fault), &fault);
}

static void write_broker(struct hub_rig *rig)
{
    static const char *const hosts[] = {"127.0.0.1", "localhost"};
    const struct broker_places places = {.folder = rig->broker_folder,
                                         .persistence = rig->broker_folder,
                                         .hub_address = "127.0.0.1",
                                         .port = rig->broker_port,
                                         .hub_port = rig->hub_broker_port,
                                         .home_assistant = true};
    struct iso_fault fault = {.text = ""};
    struct hub_ca *ca = NULL;
    bool changed = false;

    ok(hub_ca_open(rig->folder, &ca, &fault), &fault);
    ok(broker_config_write(&rig->store, ca, &places, hosts, 2, &changed, &fault), &fault);
    assert_true(changed);
    ok(broker_config_write(&rig->store, ca, &places, hosts, 2, &changed, &fault), &fault);
    assert_false(changed);
    hub_ca_free(ca);
    if (geteuid() == 0) { /* the folder of the test belongs to root */
        FILE *config = fopen(scratch_path(rig->broker_folder, "mosquitto.conf"), "a");
        assert_non_null(config);
        (void)fputs("user root\n", config);
        assert_int_equal(fclose(config), 0);
    }
}

bool hub_rig_start(struct hub_rig *rig, const char *folder)
{
    struct iso_fault fault = {.text = ""};

    memset(rig, 0, sizeof *rig);
    rig->folder = folder;
    rig->broker_folder = strdup(scratch_path(folder, "broker"));
    if (!broker_rig_is_possible() || !start_postgres(rig)) {
        return false;
    }
    ok(iso_fleet_start(&fault), &fault);
    scratch_mkdir(rig->broker_folder);
    make_store(rig);
    rig->broker_port = broker_rig_port();
    rig->hub_broker_port = broker_rig_port();
    write_broker(rig);
    broker_rig_start(&rig->broker, scratch_path(rig->broker_folder, "mosquitto.conf"),
                     rig->hub_broker_port, scratch_path(folder, "broker.log"));
    return true;
}

void hub_rig_stop(struct hub_rig *rig)
{
    for (int i = 0; i < HUB_RIG_PROCESSES; i++) {
        hub_rig_kill(rig, i);
    }
    broker_rig_stop(&rig->broker);
    hub_store_close(&rig->store);
    if (postgres.pid) {
        rig_postgres_empty(&postgres);
    }
    free((char *)(uintptr_t)rig->broker_folder);
}

void hub_rig_serve(struct hub_rig *rig, int i)
{
    char listen[32], hub_port[8], door_port[8];
    const char *keys = scratch_path(rig->folder, "hub.keys");

    rig->hubs[i].port = broker_rig_port();
    (void)snprintf(rig->hubs[i].log, sizeof rig->hubs[i].log, "%s/hub-%d.log", rig->folder, i);
    (void)snprintf(rig->hubs[i].metrics, sizeof rig->hubs[i].metrics, "%s/hub-%d.prom", rig->folder,
                   i);
    (void)unlink(rig->hubs[i].log);
    (void)snprintf(listen, sizeof listen, "127.0.0.1:%u", rig->hubs[i].port);
    (void)snprintf(hub_port, sizeof hub_port, "%u", rig->hub_broker_port);
    (void)snprintf(door_port, sizeof door_port, "%u", rig->broker_port);
    rig->hubs[i].pid = fork();
    assert_true(rig->hubs[i].pid >= 0);
    if (rig->hubs[i].pid == 0) {
        const int fd = open(rig->hubs[i].log, O_WRONLY | O_CREAT | O_APPEND, 0600);
        (void)dup2(fd, STDOUT_FILENO);
        (void)dup2(fd, STDERR_FILENO);
        (void)execl(HUB_PROCESS, HUB_PROCESS, rig->postgres->conninfo, keys, rig->folder, listen,
                    hub_port, door_port, rig->broker_folder, rig->hubs[i].metrics, (char *)NULL);
        _exit(127);
    }
    for (int k = 0; hub_rig_says(rig, i, "connected to the broker") == 0; k++) {
        if (k > 1000 || waitpid(rig->hubs[i].pid, NULL, WNOHANG) != 0) {
            fail_msg("the hub does not serve: %s",
                     scratch_exists(rig->hubs[i].log) ? scratch_read_text(rig->hubs[i].log) : "");
        }
        (void)usleep(20000);
    }
}

void hub_rig_kill(struct hub_rig *rig, int i)
{
    if (rig->hubs[i].pid > 0) {
        (void)kill(rig->hubs[i].pid, SIGKILL);
        (void)waitpid(rig->hubs[i].pid, NULL, 0);
        rig->hubs[i].pid = 0;
    }
}

int hub_rig_says(const struct hub_rig *rig, int i, const char *text)
{
    int n = 0;

    if (!scratch_exists(rig->hubs[i].log)) {
        return 0;
    }
    char *log = scratch_read_text(rig->hubs[i].log);
    for (const char *at = strstr(log, text); at; at = strstr(at + 1, text)) {
        n++;
    }
    free(log);
    return n;
}

int hub_rig_leader(struct hub_rig *rig)
{
    for (int k = 0; k < 1000; k++) {
        for (int i = 0; i < HUB_RIG_PROCESSES; i++) {
            if (rig->hubs[i].pid && hub_rig_says(rig, i, "is the leader now") >
                                        hub_rig_says(rig, i, "is not the leader any more")) {
                return i;
            }
        }
        (void)usleep(10000);
    }
    fail_msg("nobody is the leader");
    return -1;
}

const char *hub_rig_add_door(struct hub_rig *rig, const char *name)
{
    static char code[HUB_CODE_SIZE];
    struct iso_fault fault = {.text = ""};
    struct iso_fleet_id id;

    ok(hub_door_add(&rig->store, name, &rig->zone, 1, &id, code, &fault), &fault);
    return code;
}

void hub_rig_reload(struct hub_rig *rig, const char *text, bool mentions)
{
    const char *path = scratch_path(rig->broker_folder, "acl");

    for (int k = 0;; k++) {
        char *rights = scratch_read_text(path);
        const bool found = strstr(rights, text) != NULL;
        free(rights);
        if (found == mentions) {
            break;
        }
        assert_true(k < 1000);
        (void)usleep(20000);
    }
    (void)usleep(200000); /* the list of revoked certificates is written after the rights */
    broker_rig_reload(&rig->broker);
}
