/* A real mosquitto with the configuration that the hub writes: what a door may read and write, and
 * that a door which has been expelled is refused after a reload. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "enroll/hub/broker/broker_text.h"
#include "enroll/hub/broker/hub_pair.h"
#include "firmware/fleet/message/membership.h"
#include "tests/enroll/hub/rigs/broker_rig.h"
#include "tests/support/scratch.h"

enum { DOORS = 3, WORTH_WAITING_S = 1 };

static struct {
    const char *folder;
    struct hub_ca *ca;
    struct broker_rig broker;
    uint16_t port, hub_port;
    struct hub_door doors[DOORS];
    uint8_t serials[DOORS][HUB_CA_SERIAL_BYTES];
    struct iso_fleet_id zones[2];
    struct broker_client hub, client[DOORS];
} rig;

static const char *file(const char *name)
{
    return scratch_path(rig.folder, name);
}

static void run(const char *command)
{
    char line[1024];

    (void)snprintf(line, sizeof line, "cd %s && (%s) >/dev/null 2>&1", rig.folder, command);
    assert_int_equal(system(line), 0);
}

static void write_rights(void)
{
    char *text = NULL;
    size_t size = 0;
    FILE *out = open_memstream(&text, &size);

    assert_non_null(out);
    broker_text_hub(out);
    for (int i = 0; i < DOORS; i++) {
        broker_text_door(out, &rig.doors[i]);
    }
    assert_int_equal(fclose(out), 0);
    scratch_write(file("acl"), text, size);
    free(text);
}

static void write_list(size_t revoked)
{
    char *pem = NULL;

    assert_int_equal(hub_ca_revoke(rig.ca, rig.serials, revoked, time(NULL), &pem, NULL), 0);
    scratch_write_text(file("crl.pem"), pem);
    free(pem);
}

static void write_config(void)
{
    const struct broker_places places = {.folder = rig.folder,
                                         .persistence = rig.folder,
                                         .hub_address = "127.0.0.1",
                                         .port = rig.port,
                                         .hub_port = rig.hub_port};
    FILE *out = fopen(file("mosquitto.conf"), "w");

    assert_non_null(out);
    broker_text_config(out, &places);
    if (geteuid() == 0) {
        (void)fputs("user root\n", out); /* the folder of the test belongs to root */
    }
    assert_int_equal(fclose(out), 0);
}

/* A door with a key and a certificate, in the home zone `zone`. */
static void make_door(int i, int zone)
{
    struct hub_door_certificate made;
    char name[16];

    rig.doors[i] = (struct hub_door){.id = iso_fleet_id_random(), .joined_s = 1, .n_zones = 1};
    rig.doors[i].zones[0] = rig.zones[zone];
    (void)snprintf(name, sizeof name, "%d.key", i);
    run("openssl req -new -newkey ec -pkeyopt ec_paramgen_curve:P-256 -nodes -keyout k.pem "
        "-subj /CN=x -out d.csr");
    assert_int_equal(rename(file("k.pem"), file(name)), 0);
    char *csr = scratch_read_text(file("d.csr"));
    assert_int_equal(
        hub_ca_sign_door(rig.ca, csr, strlen(csr), &rig.doors[i].id, time(NULL), &made, NULL), 0);
    (void)snprintf(name, sizeof name, "%d.pem", i);
    scratch_write_text(file(name), made.pem);
    memcpy(rig.serials[i], made.serial, sizeof made.serial);
    free(csr);
    free(made.pem);
}

static void begin(struct broker_client *client, int i)
{
    char key[16], certificate[16], id[ISO_FLEET_ID_TEXT_SIZE];

    (void)snprintf(key, sizeof key, "%d.key", i);
    (void)snprintf(certificate, sizeof certificate, "%d.pem", i);
    broker_client_begin(client, iso_fleet_id_text(&rig.doors[i].id, id), rig.port, file("ca.pem"),
                        file(certificate), file(key));
}

static int setup(void **state)
{
    static const char *const hosts[] = {"127.0.0.1"};
    struct hub_pair pair;
    struct iso_fault fault = {.text = ""};

    assert_int_equal(iso_fleet_start(&fault), 0);
    assert_int_equal(scratch_setup(state), 0);
    rig.folder = *state;
    rig.port = broker_rig_port();
    rig.hub_port = broker_rig_port();
    assert_int_equal(hub_ca_open(rig.folder, &rig.ca, &fault), 0);
    assert_int_equal(
        hub_pair_open(rig.ca, rig.folder, HUB_PAIR_BROKER, hosts, 1, time(NULL), &pair, &fault), 0);
    hub_pair_free(&pair);
    assert_int_equal(
        hub_pair_open(rig.ca, rig.folder, HUB_PAIR_CLIENT, NULL, 0, time(NULL), &pair, &fault), 0);
    hub_pair_free(&pair);
    rig.zones[0] = iso_fleet_id_random();
    rig.zones[1] = iso_fleet_id_random();
    make_door(0, 0);
    make_door(1, 1);
    make_door(2, 0);
    write_rights();
    write_list(0);
    write_config();
    /* Mosquitto opens the listeners in their order. */
    broker_rig_start(&rig.broker, file("mosquitto.conf"), rig.hub_port, file("log"));
    broker_client_begin(&rig.hub, "hub-1", rig.hub_port, file("ca.pem"), file("hub-client.pem"),
                        file("hub-client-key.pem"));
    assert_true(broker_client_connects(&rig.hub));
    for (int i = 0; i < 2; i++) {
        begin(&rig.client[i], i);
        assert_true(broker_client_connects(&rig.client[i]));
    }
    return 0;
}

static int teardown(void **state)
{
    broker_client_end(&rig.hub);
    for (int i = 0; i < DOORS; i++) {
        broker_client_end(&rig.client[i]);
    }
    broker_rig_stop(&rig.broker);
    hub_ca_free(rig.ca);
    return scratch_teardown(state);
}

static void a_door_reads_its_own_zone_and_no_other(void **state)
{
    char mine[ISO_FLEET_TOPIC_SIZE], other[ISO_FLEET_TOPIC_SIZE];
    (void)state;

    iso_fleet_topic_delta(&rig.zones[0], mine);
    iso_fleet_topic_delta(&rig.zones[1], other);
    broker_client_subscribe(&rig.client[0], "#");
    broker_client_subscribe(&rig.client[0], mine);
    broker_client_subscribe(&rig.client[0], other);
    broker_client_subscribe(&rig.client[1], other);
    broker_client_publish(&rig.hub, other, "secret", 6, false);
    broker_client_publish(&rig.hub, mine, "open", 4, false);
    assert_true(broker_client_wait(&rig.client[1], other, 0, 10) >= 0);
    assert_true(broker_client_wait(&rig.client[0], mine, 0, 10) >= 0);
    assert_int_equal(broker_client_wait(&rig.client[0], other, 0, WORTH_WAITING_S), -1);
    /* Nor what the broker has retained. */
    iso_fleet_topic_head(&rig.zones[1], other);
    broker_client_publish(&rig.hub, other, "head", 4, true);
    broker_client_subscribe(&rig.client[0], other);
    assert_int_equal(broker_client_wait(&rig.client[0], other, 0, WORTH_WAITING_S), -1);
}

static void a_door_reads_its_own_mail_alone(void **state)
{
    char mine[ISO_FLEET_TOPIC_SIZE], other[ISO_FLEET_TOPIC_SIZE];
    (void)state;

    iso_fleet_topic_in(&rig.doors[0].id, mine);
    iso_fleet_topic_in(&rig.doors[1].id, other);
    broker_client_subscribe(&rig.client[0], "isotherm/door/+/in");
    broker_client_publish(&rig.hub, other, "key", 3, false);
    broker_client_publish(&rig.hub, mine, "key", 3, false);
    assert_true(broker_client_wait(&rig.client[0], mine, 0, 10) >= 0);
    assert_int_equal(broker_client_wait(&rig.client[0], other, 0, WORTH_WAITING_S), -1);
}

static void a_door_writes_in_its_own_name_alone(void **state)
{
    char topic[ISO_FLEET_TOPIC_SIZE];
    (void)state;

    broker_client_subscribe(&rig.hub, ISO_FLEET_TOPIC_ALL_OUT);
    broker_client_subscribe(&rig.hub, ISO_FLEET_TOPIC_ALL_ONLINE);
    broker_client_subscribe(&rig.client[1], iso_fleet_topic_delta(&rig.zones[1], topic));
    broker_client_publish(&rig.client[0], topic, "forged", 6, false);
    assert_int_equal(broker_client_wait(&rig.client[1], topic, 0, WORTH_WAITING_S), -1);
    iso_fleet_topic_out(&rig.doors[1].id, topic);
    broker_client_publish(&rig.client[0], topic, "forged", 6, false);
    assert_int_equal(broker_client_wait(&rig.hub, topic, 0, WORTH_WAITING_S), -1);
    iso_fleet_topic_online(&rig.doors[1].id, topic);
    broker_client_publish(&rig.client[0], topic, "0", 1, true);
    assert_int_equal(broker_client_wait(&rig.hub, topic, 0, WORTH_WAITING_S), -1);
    iso_fleet_topic_out(&rig.doors[0].id, topic);
    broker_client_publish(&rig.client[0], topic, "mine", 4, false);
    assert_true(broker_client_wait(&rig.hub, topic, 0, 10) >= 0);
    iso_fleet_topic_online(&rig.doors[0].id, topic);
    broker_client_publish(&rig.client[0], topic, "1", 1, true);
    assert_true(broker_client_wait(&rig.hub, topic, 0, 10) >= 0);
}

static void nobody_comes_in_without_a_certificate_of_the_hub(void **state)
{
    struct broker_client stranger;
    (void)state;

    broker_client_begin(&stranger, "a", rig.port, file("ca.pem"), NULL, NULL);
    assert_false(broker_client_connects(&stranger));
    broker_client_end(&stranger);
    run("openssl req -x509 -newkey ec -pkeyopt ec_paramgen_curve:P-256 -nodes -keyout s.key "
        "-subj /CN=hub -days 9 -out s.pem");
    broker_client_begin(&stranger, "b", rig.port, file("ca.pem"), file("s.pem"), file("s.key"));
    assert_false(broker_client_connects(&stranger));
    broker_client_end(&stranger);
    broker_client_begin(&stranger, "c", rig.port, NULL, NULL, NULL);
    assert_false(broker_client_connects(&stranger));
    broker_client_end(&stranger);
}

static void an_expelled_door_is_refused_after_a_reload(void **state)
{
    char topic[ISO_FLEET_TOPIC_SIZE], in[ISO_FLEET_TOPIC_SIZE], from[ISO_FLEET_TOPIC_SIZE];
    (void)state;

    iso_fleet_topic_in(&rig.doors[0].id, in);
    iso_fleet_topic_out(&rig.doors[0].id, from);
    iso_fleet_topic_delta(&rig.zones[0], topic);
    broker_client_subscribe(&rig.hub, from);
    broker_client_subscribe(&rig.client[0], in);
    broker_client_subscribe(&rig.client[0], topic);
    broker_client_publish(&rig.hub, topic, "before", 6, false);
    assert_true(broker_client_wait(&rig.client[0], topic, 0, 10) >= 0);
    rig.doors[0].expelled_s = 1;
    write_rights();
    write_list(1);
    broker_rig_reload(&rig.broker);
    /* The connection that it has gets nothing more. */
    broker_client_publish(&rig.hub, topic, "after", 5, false);
    assert_int_equal(broker_client_wait(&rig.client[0], topic, 1, WORTH_WAITING_S), -1);
    broker_client_publish(&rig.hub, in, "after", 5, false);
    assert_int_equal(broker_client_wait(&rig.client[0], in, 0, WORTH_WAITING_S), -1);
    broker_client_publish(&rig.client[0], from, "after", 5, false);
    assert_int_equal(broker_client_wait(&rig.hub, from, 0, WORTH_WAITING_S), -1);
    broker_client_end(&rig.client[0]);
    begin(&rig.client[0], 0);
    assert_false(broker_client_connects(&rig.client[0]));
    begin(&rig.client[2], 2);
    assert_true(broker_client_connects(&rig.client[2]));
}

static void a_new_door_is_admitted_after_a_reload(void **state)
{
    char topic[ISO_FLEET_TOPIC_SIZE];
    (void)state;

    rig.doors[2].joined_s = 0;
    write_rights();
    broker_rig_reload(&rig.broker);
    begin(&rig.client[2], 2);
    assert_true(broker_client_connects(&rig.client[2]));
    broker_client_subscribe(&rig.hub, ISO_FLEET_TOPIC_ALL_OUT);
    iso_fleet_topic_out(&rig.doors[2].id, topic);
    broker_client_publish(&rig.client[2], topic, "early", 5, false);
    assert_int_equal(broker_client_wait(&rig.hub, topic, 0, WORTH_WAITING_S), -1);
    rig.doors[2].joined_s = 1;
    write_rights();
    broker_rig_reload(&rig.broker);
    broker_client_publish(&rig.client[2], topic, "now", 3, false);
    assert_true(broker_client_wait(&rig.hub, topic, 0, 10) >= 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(a_door_reads_its_own_zone_and_no_other, setup, teardown),
        cmocka_unit_test_setup_teardown(a_door_reads_its_own_mail_alone, setup, teardown),
        cmocka_unit_test_setup_teardown(a_door_writes_in_its_own_name_alone, setup, teardown),
        cmocka_unit_test_setup_teardown(nobody_comes_in_without_a_certificate_of_the_hub, setup,
                                        teardown),
        cmocka_unit_test_setup_teardown(an_expelled_door_is_refused_after_a_reload, setup,
                                        teardown),
        cmocka_unit_test_setup_teardown(a_new_door_is_admitted_after_a_reload, setup, teardown),
    };
    return broker_rig_is_possible() ? cmocka_run_group_tests(tests, NULL, NULL) : 77;
}
