/* The pages inside Cockpit, which has loaded base1/cockpit.js before. */

import {loadPreferredLanguage} from './base/i18n.js';
import {makeApp} from './app.js';
import {makeCockpitApi} from './transport/cockpit.js';

const { cockpit } = globalThis;

await loadPreferredLanguage([cockpit.language, ...(navigator.languages ?? [])].filter(Boolean));
cockpit.permission({ admin: true }); /* loads the page again when the user turns administrative access on or off */
const api = makeCockpitApi(cockpit);
addEventListener('pagehide', api.abandon);
await makeApp(api, document.getElementById('app'))();
