#include "enroll/hub/broker/broker_text.h"

#include "enroll/hub/broker/hub_pair.h"
#include "firmware/fleet/message/membership.h"

/* The limits: a door that is too slow loses messages and fetches them over HTTPS, so a queue needs
 * no more room than a burst of changes. The hub gets a QUESTION of every door at once after the
 * broker has started. The widest message is a delta (ISO_FLEET_MESSAGE_MAX). */
static const char head[] =
    "# Written by `isotherm-hub broker-config`: do not edit, it is written anew.\n"
    "# A whole configuration: mosquitto -c THIS_FILE, or in place of "
    "/etc/mosquitto/mosquitto.conf.\n"
    "# After a change of doors: kill -HUP the broker; `isotherm-hub serve` keeps the rights of the "
    "doors up by itself.\n"
    "per_listener_settings false\n"
    "allow_anonymous false\n"
    "persistence true\n"
    "autosave_interval 60\n"
    "max_inflight_messages 1000\n"
    "max_queued_messages 20000\n"
    "max_queued_bytes 67108864\n"
    "message_size_limit 4259840\n"
    "max_keepalive 120\n"
    "persistent_client_expiration 1d\n"
    "set_tcp_nodelay true\n"
    "log_dest stderr\n"
    "log_type error\n"
    "log_type warning\n"
    "log_type notice\n";

static void listener(FILE *out, const struct broker_places *places, uint16_t port,
                     const char *address)
{
    (void)fprintf(out, "\nlistener %u%s%s\n", port, *address ? " " : "", address);
    (void)fprintf(out,
                  "cafile %s/ca.pem\n"
                  "certfile %s/%s\n"
                  "keyfile %s/%s\n"
                  "crlfile %s/crl.pem\n"
                  "require_certificate true\n"
                  "use_identity_as_username true\n",
                  places->folder, places->folder, hub_pair_chain_name(HUB_PAIR_BROKER),
                  places->folder, hub_pair_key_name(HUB_PAIR_BROKER), places->folder);
}

void broker_text_config(FILE *out, const struct broker_places *places)
{
    (void)fputs(head, out);
    (void)fprintf(out, "persistence_location %s/\nacl_file %s/acl\n", places->persistence,
                  places->folder);
    (void)fputs("\n# The doors.", out);
    listener(out, places, places->port, "");
    if (places->hub_port) {
        (void)fputs("\n# The hub.", out);
        listener(out, places, places->hub_port, places->hub_address);
    }
}

void broker_text_hub(FILE *out)
{
    (void)fputs("# Written by `isotherm-hub broker-config`: do not edit, it is written anew.\n\n"
                "user " HUB_PAIR_CLIENT_NAME "\n"
                "topic read " ISO_FLEET_TOPIC_ALL_OUT "\n"
                "topic read " ISO_FLEET_TOPIC_ALL_ONLINE "\n"
                "topic write isotherm/door/+/in\n"
                "topic write isotherm/door/+/state\n"
                "topic write isotherm/zone/+/delta\n"
                "topic write isotherm/zone/+/head\n"
                "topic write homeassistant/#\n"
                "\nuser " HUB_PAIR_HOME_NAME "\n"
                "topic read homeassistant/#\n"
                "topic read isotherm/door/+/state\n"
                "topic read " ISO_FLEET_TOPIC_ALL_ONLINE "\n"
                "\n# Every client in its own name, which is that of its certificate. Mosquitto\n"
                "# looks through all users for each of their lines, so a line of all is cheap.\n"
                "pattern read isotherm/door/%u/in\n"
                "pattern write isotherm/door/%u/out\n"
                "pattern write isotherm/door/%u/online\n",
                out);
}

void broker_text_door(FILE *out, const struct hub_door *door)
{
    char id[ISO_FLEET_ID_TEXT_SIZE], topic[ISO_FLEET_TOPIC_SIZE];

    (void)fprintf(out, "\nuser %s\n", iso_fleet_id_text(&door->id, id));
    if (door->joined_s == 0 || door->expelled_s != 0) {
        (void)fputs("topic deny #\n", out); /* counts before the patterns */
        return;
    }
    for (size_t i = 0; i < door->n_zones; i++) {
        (void)fprintf(out, "topic read %s\n", iso_fleet_topic_delta(&door->zones[i], topic));
        (void)fprintf(out, "topic read %s\n", iso_fleet_topic_head(&door->zones[i], topic));
    }
}
