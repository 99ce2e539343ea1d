/* The pages of the hub of a fleet. */

import {loadPreferredLanguage} from './base/i18n.js';
import {FLEET_FAULTS} from './base/fleet_words.js';
import {makeFrame} from './frame.js';
import {makeFleet} from './fleet.js';
import {hub} from './transport/hub.js';
import {addFaultWords} from './transport/fault.js';
import {accounts} from './pages/accounts.js';
import {doors} from './pages/doors.js';
import {fleetBanner} from './pages/fleet_banner.js';
import {fleetPeople} from './pages/fleet_people.js';
import {lockdown} from './pages/lockdown.js';
import {overview} from './pages/overview.js';
import {requests} from './pages/requests.js';
import {updates} from './pages/updates.js';
import {where} from './pages/where.js';

const PAGES = [overview, doors, fleetPeople, requests, where, lockdown, updates, accounts];

addFaultWords(FLEET_FAULTS);
await loadPreferredLanguage();
await makeFrame(hub, document.getElementById('app'), { all: PAGES, makeState: makeFleet, banner: fleetBanner })();
