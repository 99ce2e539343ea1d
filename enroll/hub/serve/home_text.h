/* How Home Assistant sees a door: MQTT discovery with four sensors that cannot be commanded. Nobody
 * is named. Pure.
 *
 *   homeassistant/binary_sensor/isotherm-DOOR/PART/config   retained
 *   isotherm/door/DOOR/state                 {"lock": "ON", ...}, retained
 *   isotherm/door/DOOR/online                "1" or "0": whether the sensors are available */
#ifndef HUB_SERVE_HOME_TEXT_H
#define HUB_SERVE_HOME_TEXT_H

#include "enroll/hub/store/hub_door.h"

/* ON means: not locked, open, opened by force or its case is open, closed to everybody. */
enum home_part { HOME_LOCK, HOME_CONTACT, HOME_TAMPER, HOME_LOCKDOWN, HOME_PARTS };

enum { HOME_TOPIC_SIZE = 128 };

const char *home_topic_config(const struct hub_door *door, enum home_part part,
                              char topic[HOME_TOPIC_SIZE]);
const char *home_topic_state(const struct hub_door *door, char topic[HOME_TOPIC_SIZE]);

/* The text of a message, which the caller frees with free(); NULL: there is no memory. */
char *home_config(const struct hub_door *door, enum home_part part, const char *hub_name);

/* From the door's last report (the words of firmware/contract/status_keys.h: "door-state",
 * "tamper", 0 or 1); what it does not say is null. */
char *home_state(const struct hub_door *door, bool is_lockdown);

#endif
