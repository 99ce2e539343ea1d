/* The keys of the replies of GetStatus and GetSite, and of the signal View (contract.h), with the
 * types of their values. */
/* clang-format off */
/* GetStatus keys:
 *   "version" s, "uptime-ms" x, "frames" t, "last-outcome" s, "log-sequence" t
 *   "mode" s                  "watch", "claimed", "enroll", "verify", "identify"
 *   "sensor" s                its back end
 *   "sensor-model" s          "" while unknown
 *   "sensor-state" s          "started"; "silent": it runs, but nothing is seen; "repeats": it
 *                             delivers frames of the last ten minutes again; "lost"
 *   "sensor-fault" s
 *   "sensor-health" s         what its driver reports while it runs; "" while all is well
 *   "sensor-calibration" s    the calibration; "" if the sensor calibrates itself. It begins with
 *                             "nominal" if the intrinsics are those of the model and were not
 *                             measured on this camera
 *   "sensor-devices" s        the devices that the back end sees; "" if it cannot tell. If the
 *                             state is not "started", only a back end that answers at once is asked
 *   "clock-fault" s           the clock was set back to before the newest record of the log; ""
 *                             while it is right
 *   "stale-fault" s           a grant has hardly enough time; "" while it has enough
 *   "storage-fault" s         the last error of the disk; "" once it works again
 *   "counter-fault" s         a fault of the counter of the state; "" while it works or none is
 *                             configured
 *   "key-place" s             where the key of the appliance is: "credential" of the service manager,
 *                             or "file"
 *   "door" s                  its back end
 *   "door-state" s
 *   "door-lines" s            the lines that are wired
 *   "door-fault" s            "" while its lines work
 *   "door-realtime" b         false: its thread has no real-time priority, and may be late on a
 *                             busy machine
 *   "panel-state" s           the access panel (OSDP): "off": none is configured; "gone": its line;
 *                             "offline"; "waiting": it has not opened the secure channel yet;
 *                             "default-key": it may only set its key; "plain"; "secure".
 *                             If it is not "off":
 *   "panel-fault" s           the line cannot be used, the panel is silent, or its stored key cannot
 *                             be used; "" while all is well; "panel-fault-code" s
 *   "panel-lamp" s            what the panel shows: "off", "red", "green", "amber", "blue",
 *                             "magenta", "cyan", "white"; "panel-buzzer" b; "panel-text" s, of up to
 *                             two lines of 16 characters
 *   "panel-install" b         the panel may set its key by the default key
 *   "panel-cards" t           cards that the panel has got, "panel-cards-lost" t that it has not
 *   "people" u                of these, "people-valid" u may come in at this time
 *   "templates" u             of these, the running algorithm can use "templates-usable" u
 *   "capacity" u, "threshold" d, "algorithm" s, "model" s (checksum)
 *   "site" s                  "off"; "provisional": the metric shall adapt to the people and has
 *                             not done so yet, because they are too few or have just changed; the
 *                             threshold is stricter then; "adapted". If it is not "off":
 *   "site-people" u           people it has learned from; of these, "site-taught" u have at least
 *                             two templates
 *   "site-least" u            people that it needs to adapt
 *   "site-excluded" u         templates that do not teach it, because of ResetSite or RollBackSite
 *   "site-other-sensor" u     people who do not teach it, because no template of theirs was made
 *                             before this class of sensor (its model); they are identified all the same
 *   "site-offset" d           how far the mean of these people is from the mean of rendered people,
 *                             in standard deviations of a rendered person; as many rendered people
 *                             would give "site-expected" d
 *   "site-growth" d           variance within a person as a multiple of the rendered one; 0: not
 *                             known
 *   "image-check" s           "off", "flag", "veto", "absent"
 *   "policy-revision" t       of the stored policy; 0: there is none
 *   "policy-fault" s          why the policy cannot be used, so that nobody is let in; "" if it can
 *   "reader-state" s          of the card reader: "off" (there is none), "works", "lost"
 *   "reader-fault" s
 *   "lockdown" b
 *   "lockout-ms" x            how long nobody is let in; 0: not locked out
 *   "visits-allowed" t, "visits-denied" t       since the start; of the denied visits,
 *   "visits-attack" t                           so many looked like a picture, screen or mask
 *   "attack-frames" t                           frames that looked so, since the start
 *   "sensor-fault-code" s, "sensor-health-code" s, "sensor-calibration-code" s,
 *   "sensor-devices-code" s, "door-fault-code" s, "clock-fault-code" s, "stale-fault-code" s,
 *   "storage-fault-code" s, "counter-fault-code" s,
 *   "policy-fault-code" s, "reader-fault-code" s
 *                             the kind of fault that the text of that key describes: a name of
 *                             core/base/fault_code.h such as "disk-full", which keeps its meaning
 *                             in later versions. "" while there is no fault, or if it has no code
 *                             ("clock-unset" has no text)
 *
 * GetSite keys: "site" and the "site-..." keys above. If the thread of the site has compared the
 * templates of the present people (firmware/site/site_estimate.h):
 *   "estimate-people" u       people who were compared; of these, "estimate-repeated" u have at
 *                             least two templates
 *   "estimate-same" t         comparisons of a template with the same person's other templates
 *   "estimate-others" t       comparisons of a template with another person
 *   "LEVEL-score" d           LEVEL is a word ISO_CONTRACT_LEVEL_...; the score of the level
 *   "LEVEL-fmr" d, "LEVEL-fmr-low" d, "LEVEL-fmr-high" d
 *                             the share of comparisons with another person that reach it, with a
 *                             95 % interval that takes people as independent; none without such a
 *                             comparison
 *   "LEVEL-fnmr" d, "LEVEL-fnmr-low" d, "LEVEL-fnmr-high" d
 *                             the same for comparisons with the same person that do not reach it
 *   "look-alikes" u           pairs of people who reach "look-alike-score" d, which is one below the
 *                             threshold; at most 16 are counted
 * Scores are those of the metric alone. At the door the surfaces are compared, too.
 *
 * Keys of the last frame that was examined, as far as they are known:
 * + "capture" s               a word of isotherm/capture.h
 * + "distance-mm" d, + "right-mm" d, + "down-mm" d        of the nose tip, from the sensor's axis
 * + "yaw-deg" d, + "pitch-deg" d, + "roll-deg" d          of the head
 * + "residual-mm" d, + "fit-coverage" d (0..1)            of the fitted head model
 * + "coverage" d (0..1)                                   of the face patch
 * + "landmark-sigma-mm" d                                 of the least certain landmark
 * + "expression" d                                        its strength in standard deviations
 * + "speed-mm-s" d, + "speed-deg-s" d
 * None of these tells one face from another. */
/* clang-format on */
#ifndef ISO_FIRMWARE_CONTRACT_STATUS_KEYS_H
#define ISO_FIRMWARE_CONTRACT_STATUS_KEYS_H

/* The words of "site" in GetStatus. */
#define ISO_CONTRACT_SITE_OFF         "off"
#define ISO_CONTRACT_SITE_PROVISIONAL "provisional"
#define ISO_CONTRACT_SITE_ADAPTED     "adapted"

/* What the policy wants of the person at the door besides what was shown: the signal Wanted, and
 * the reason in a record of Watch whose verdict is ISO_CONTRACT_VERDICT_WAIT. */
#define ISO_CONTRACT_VERDICT_WAIT  "wait"
#define ISO_CONTRACT_WANTED_FACE   "face"
#define ISO_CONTRACT_WANTED_CARD   "card"
#define ISO_CONTRACT_WANTED_PIN    "pin"
#define ISO_CONTRACT_WANTED_PERSON "person" /* a second person, or an escort */

/* The words of the levels in GetSite. */
#define ISO_CONTRACT_LEVEL_CONVENIENT "convenient"
#define ISO_CONTRACT_LEVEL_BALANCED   "balanced"
#define ISO_CONTRACT_LEVEL_STRICT     "strict"

#endif
