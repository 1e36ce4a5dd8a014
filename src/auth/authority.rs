//! A certificate authority in a directory, and the identities that it issues.

use super::{AuthError, Role};
use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use rcgen::{
    BasicConstraints, CertificateParams, DnType, ExtendedKeyUsagePurpose, IsCa, Issuer, KeyPair,
    KeyUsagePurpose,
};
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::time::Duration;
use time::OffsetDateTime;

/// Clocks of others may be behind by so much.
const BEHIND: Duration = Duration::from_secs(3_600);
/// How long an authority is valid.
const AUTHORITY_VALID: Duration = Duration::from_secs(10 * 365 * 86_400);

/// What signs certificates: `ca.pem`, and `ca.key`, which whoever has can make any role.
pub struct Authority {
    directory: PathBuf,
    certificate: String,
    issuer: Issuer<'static, KeyPair>,
}

/// An identity to be issued.
#[derive(Clone, Debug)]
pub struct Request {
    /// What it may do.
    pub role: Role,
    /// Whose it is, for `auth show`: it gives no rights.
    pub name: Option<String>,
    /// Names and addresses under which a daemon is reached; for others none.
    pub hosts: Vec<String>,
    /// From now on.
    pub valid: Duration,
}

impl Authority {
    /// Makes an authority in a directory.
    ///
    /// # Errors
    /// One is there, or the directory cannot be written.
    pub fn create(directory: &Path) -> Result<Self, AuthError> {
        let io = |path: &Path, source| AuthError::Io {
            path: path.to_owned(),
            source,
        };
        std::fs::create_dir_all(directory).map_err(|e| io(directory, e))?;
        let key = KeyPair::generate().map_err(|e| wrong("the authority's key", e))?;
        let what = "the authority's certificate";
        let mut params = CertificateParams::default();
        params
            .distinguished_name
            .push(DnType::CommonName, "Palpate authority");
        // It signs people and machines, not other authorities.
        params.is_ca = IsCa::Ca(BasicConstraints::Constrained(0));
        params.key_usages = vec![KeyUsagePurpose::KeyCertSign, KeyUsagePurpose::CrlSign];
        let now = OffsetDateTime::now_utc();
        (params.not_before, params.not_after) = (now - BEHIND, now + AUTHORITY_VALID);
        let certificate = params.self_signed(&key).map_err(|e| wrong(what, e))?.pem();
        write_new(&directory.join("ca.key"), &key.serialize_pem(), true)?;
        write_new(&directory.join("ca.pem"), &certificate, false)?;
        Ok(Self {
            directory: directory.to_owned(),
            certificate,
            issuer: Issuer::new(params, key),
        })
    }

    /// The authority of a directory.
    ///
    /// # Errors
    /// None is there, its files do not parse, or others can read its key.
    pub fn open(directory: &Path) -> Result<Self, AuthError> {
        palpate_client::check_private(&directory.join("ca.key")).map_err(AuthError::Readable)?;
        let read = |name: &str| {
            let path = directory.join(name);
            std::fs::read_to_string(&path).map_err(|source| match source.kind() {
                std::io::ErrorKind::NotFound => AuthError::NoAuthority(directory.to_owned()),
                _ => AuthError::Io { path, source },
            })
        };
        let (certificate, key) = (read("ca.pem")?, read("ca.key")?);
        let file = |name: &str| directory.join(name).display().to_string();
        let key = KeyPair::from_pem(&key).map_err(|e| wrong(file("ca.key"), e))?;
        let issuer =
            Issuer::from_ca_cert_pem(&certificate, key).map_err(|e| wrong(file("ca.pem"), e))?;
        Ok(Self {
            directory: directory.to_owned(),
            certificate,
            issuer,
        })
    }

    /// Issues an identity and writes it to `target`, or to a file named after its role.
    ///
    /// # Errors
    /// A host that is neither a name nor an address, a file that is there already or cannot be
    /// written.
    pub fn issue(&self, request: &Request, target: Option<&Path>) -> Result<PathBuf, AuthError> {
        let name = match &request.name {
            Some(name) => format!("{}-{name}.json5", request.role.stem()),
            None => format!("{}.json5", request.role.stem()),
        };
        let path = target.map_or_else(|| self.directory.join(name), Path::to_owned);
        let text = self.identity(request, OffsetDateTime::now_utc() - BEHIND)?;
        write_new(&path, &text, true)?;
        Ok(path)
    }

    /// The text of an identity file that is valid from a moment on.
    ///
    /// # Errors
    /// A host that is neither a name nor an address.
    pub fn identity(&self, request: &Request, from: OffsetDateTime) -> Result<String, AuthError> {
        let role = &request.role;
        if let Some(host) = request.hosts.iter().find(|host| !is_host(host)) {
            let reason = "it is neither a name like lab.example nor an address";
            return Err(wrong(format!("host {host:?}"), reason));
        }
        let mut params = CertificateParams::new(request.hosts.clone())
            .map_err(|e| wrong(format!("--host {}", request.hosts.join(" ")), e))?;
        params.distinguished_name = rcgen::DistinguishedName::new();
        params
            .distinguished_name
            .push(DnType::CommonName, role.to_string());
        if let Some(name) = &request.name {
            params
                .distinguished_name
                .push(DnType::OrganizationalUnitName, name.as_str());
        }
        params.key_usages = vec![KeyUsagePurpose::DigitalSignature];
        params.use_authority_key_identifier_extension = true;
        // A client's certificate cannot stand in for a daemon.
        params.extended_key_usages = vec![ExtendedKeyUsagePurpose::ClientAuth];
        if *role == Role::Daemon {
            params
                .extended_key_usages
                .push(ExtendedKeyUsagePurpose::ServerAuth);
        }
        (params.not_before, params.not_after) = (from, from + BEHIND + request.valid);
        let what = format!("the certificate of {role}");
        let key = KeyPair::generate().map_err(|e| wrong(&what, e))?;
        let certificate = params
            .signed_by(&key, &self.issuer)
            .map_err(|e| wrong(&what, e))?;
        let (key, certificate) = (key.serialize_pem(), certificate.pem());
        Ok(zenoh_text(role, &self.certificate, &key, &certificate))
    }
}

/// The identity as a Zenoh configuration: what `--identity` takes, and any Zenoh program.
fn zenoh_text(role: &Role, authority: &str, key: &str, certificate: &str) -> String {
    let (key, certificate) = (STANDARD.encode(key), STANDARD.encode(certificate));
    let mut tls = serde_json::json!({
        "root_ca_certificate_base64": STANDARD.encode(authority),
        "enable_mtls": true,
        "verify_name_on_connect": true,
        "close_link_on_expiration": true,
        "connect_private_key_base64": key,
        "connect_certificate_base64": certificate,
    });
    let mut whole = serde_json::json!({ "scouting": { "multicast": { "enabled": false } } });
    if *role == Role::Daemon {
        tls["listen_private_key_base64"] = key.into();
        tls["listen_certificate_base64"] = certificate.into();
    } else {
        // Zenoh's default listens on all interfaces.
        whole["mode"] = "client".into();
    }
    whole["transport"] = serde_json::json!({ "link": { "tls": tls } });
    format!(
        "// Identity {role} for Palpate: it contains a private key. palpate … --identity FILE\n{whole:#}\n"
    )
}

/// An address, or labels with dots between them.
fn is_host(text: &str) -> bool {
    let label = |label: &str| {
        let fits = |b: u8| b.is_ascii_alphanumeric() || b == b'-' || b == b'_';
        (1..=63).contains(&label.len()) && label.bytes().all(fits)
    };
    text.parse::<std::net::IpAddr>().is_ok() || (text.len() <= 253 && text.split('.').all(label))
}

fn wrong(what: impl std::fmt::Display, reason: impl std::fmt::Display) -> AuthError {
    AuthError::Certificate {
        what: what.to_string(),
        reason: reason.to_string(),
    }
}

/// Writes a file that is not there; a secret one is its owner's only, from the first byte on.
fn write_new(path: &Path, text: &str, secret: bool) -> Result<(), AuthError> {
    let mut options = std::fs::OpenOptions::new();
    options.write(true).create_new(true);
    #[cfg(unix)]
    {
        use std::os::unix::fs::OpenOptionsExt as _;
        options.mode(if secret { 0o600 } else { 0o644 });
    }
    let written = options.open(path).and_then(|mut file| {
        file.write_all(text.as_bytes())
            .and_then(|()| file.sync_all())
    });
    written.map_err(|source| match source.kind() {
        std::io::ErrorKind::AlreadyExists => AuthError::Exists(path.to_owned()),
        _ => AuthError::Io {
            path: path.to_owned(),
            source,
        },
    })
}
