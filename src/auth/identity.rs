//! What an identity file says of itself.

use super::{AuthError, Role};
use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use std::path::Path;
use time::OffsetDateTime;
use x509_parser::extensions::GeneralName;
use x509_parser::pem::parse_x509_pem;

/// An identity file, read: its certificate, without the key.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Identity {
    /// Common name of the certificate.
    pub common_name: String,
    /// What it may do; `None`: nothing.
    pub role: Option<Role>,
    /// Whose it is, if it says so.
    pub name: Option<String>,
    /// Names and addresses for which it is a daemon's.
    pub hosts: Vec<String>,
    /// First moment.
    pub from: OffsetDateTime,
    /// Last moment.
    pub until: OffsetDateTime,
    /// Others on this machine can read the file.
    pub readable_by_others: bool,
}

impl Identity {
    /// Reads an identity file.
    ///
    /// # Errors
    /// It cannot be read, or has no certificate.
    pub fn read(path: &Path) -> Result<Self, AuthError> {
        let wrong = |reason: String| AuthError::Certificate {
            what: path.display().to_string(),
            reason,
        };
        let tls = palpate_client::identity(path).map_err(wrong)?;
        let encoded = tls["connect_certificate_base64"].as_str();
        let encoded = encoded.ok_or_else(|| wrong("it has no certificate".into()))?;
        let pem = STANDARD.decode(encoded).map_err(|e| wrong(e.to_string()))?;
        let (_, pem) = parse_x509_pem(&pem).map_err(|e| wrong(e.to_string()))?;
        let certificate = pem.parse_x509().map_err(|e| wrong(e.to_string()))?;
        // Zenoh would print both where it finds that they do not fit.
        let key = tls["connect_private_key_base64"]
            .as_str()
            .unwrap_or_default();
        let key = STANDARD.decode(key).map_err(|e| wrong(e.to_string()))?;
        let key = rcgen::KeyPair::from_pem(&String::from_utf8_lossy(&key));
        let key = key.map_err(|e| wrong(format!("its key: {e}")))?;
        if key.public_key_raw() != &*certificate.public_key().subject_public_key.data {
            return Err(wrong("its key is not that of its certificate".into()));
        }
        let subject = certificate.subject();
        let first = |name: Option<&x509_parser::x509::AttributeTypeAndValue<'_>>| {
            name.and_then(|name| name.as_str().ok()).map(str::to_owned)
        };
        let common_name = first(subject.iter_common_name().next()).unwrap_or_default();
        let names = certificate.subject_alternative_name().ok().flatten();
        let hosts = names.map_or_else(Vec::new, |names| {
            names.value.general_names.iter().filter_map(host).collect()
        });
        let validity = certificate.validity();
        Ok(Self {
            role: Role::of(&common_name),
            name: first(subject.iter_organizational_unit().next()),
            hosts,
            from: validity.not_before.to_datetime(),
            until: validity.not_after.to_datetime(),
            readable_by_others: palpate_client::check_private(path).is_err(),
            common_name,
        })
    }

    /// Reads an identity that is going to be used now.
    ///
    /// # Errors
    /// As of [`Identity::read`]; others can read its key; it has expired, or is not valid yet.
    pub fn usable(path: &Path) -> Result<Self, AuthError> {
        palpate_client::check_private(path).map_err(AuthError::Readable)?;
        let identity = Self::read(path)?;
        let now = OffsetDateTime::now_utc();
        let reason = match identity.is_valid_at(now) {
            true => return Ok(identity),
            false if identity.until < now => format!("it has expired on {}", identity.until),
            false => format!("it is not valid before {}", identity.from),
        };
        Err(AuthError::Certificate {
            what: path.display().to_string(),
            reason: format!("{reason}; `palpate auth issue` makes a new one"),
        })
    }

    /// It is valid at a moment.
    pub fn is_valid_at(&self, moment: OffsetDateTime) -> bool {
        (self.from..=self.until).contains(&moment)
    }
}

fn host(name: &GeneralName<'_>) -> Option<String> {
    match name {
        GeneralName::DNSName(name) => Some((*name).to_owned()),
        GeneralName::IPAddress(bytes) => {
            let four =
                <[u8; 4]>::try_from(*bytes).map(|bytes| std::net::Ipv4Addr::from(bytes).into());
            let six =
                <[u8; 16]>::try_from(*bytes).map(|bytes| std::net::Ipv6Addr::from(bytes).into());
            four.or(six)
                .ok()
                .map(|address: std::net::IpAddr| address.to_string())
        }
        _ => None,
    }
}
